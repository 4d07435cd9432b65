"""Checkpoints of a run: every array of its workspace, in one file that appears whole or not at all."""

from __future__ import annotations

import hashlib
import os
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from dynamics.errors import ResultError
from dynamics.kernels.by_address import by_value

VERSION = 3  # version of the content of checkpoints
_VALUE = "fact "  # prefix of the values beside the state, by which a file tells both apart
Arrays = dict[str, Any]


def leaves_of(state: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the dotted names and values of all that nested (named) tuples hold."""
    state = by_value(state)
    if not isinstance(state, tuple):
        yield name, state
        return
    fields = getattr(state, "_fields", range(len(state)))
    for field, value in zip(fields, state, strict=True):
        yield from leaves_of(value, f"{name}.{field}" if name else str(field))


def fingerprint(*parts: Any) -> str:
    """Return the SHA-256 of names, types, shapes and bytes of everything in `parts`."""
    digest = hashlib.sha256(f"checkpoint {VERSION}".encode())
    for name, value in leaves_of(parts):
        array = np.asarray(value)
        digest.update(f"{name} {array.dtype.str} {array.shape};".encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()


def restore(state: Any, arrays: Arrays, path: Path) -> None:
    """Write `arrays` into the arrays of `state`, in place.

    Raises
    ------
    ResultError
        If one is missing or of another shape or type: the file is of another version of the program.
    """
    for name, target in leaves_of(state):
        stored = arrays.get(name)
        if stored is None or stored.shape != target.shape or stored.dtype != target.dtype:
            raise ResultError(f"{path}: {name} is not that of this version. Start a new run.")
        target[...] = stored


def write_checkpoint(path: Path, state: Any, **values: Any) -> None:
    """Write the arrays of `state`, and `values`, to a neighbor of `path`; then move it there in one step."""
    part = path.with_suffix(".part")
    with part.open("wb") as file:
        named_values = {f"{_VALUE}{name}": value for name, value in values.items()}
        np.savez(file, **dict(leaves_of(state)), **named_values)
        file.flush()
        os.fsync(file.fileno())
    part.replace(path)


def read_checkpoint(path: Path) -> tuple[Arrays, Arrays]:
    """Return the arrays of the state, and the values that were written with it.

    Raises
    ------
    ResultError
        If the file is damaged.
    """
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            content = {name: file[name] for name in file.files}
    except (OSError, ValueError, zipfile.BadZipFile, KeyError) as error:
        raise ResultError(f"{path.name}: not a readable checkpoint. Start a new run.") from error
    values = {name.removeprefix(_VALUE): content[name] for name in content if name.startswith(_VALUE)}
    return {name: value for name, value in content.items() if not name.startswith(_VALUE)}, values
