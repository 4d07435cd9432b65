"""Disk cache of flank compliances and root stresses, by the hash of all their inputs."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import time
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, fields
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from fe_contact.cache_reads import COMPLIANCE_READS
from fe_contact.compliance.flank import ComplianceChecks, FlankCompliance, FlankCompliance3D
from fe_contact.compliance.root_stress import RootStressChecks, UnitRootStress
from fe_contact.types import Json
from host import lock

CACHED_KEYS = 64
"""Number of the hashes of the last requests that stay in memory."""
PATIENCE_S = 600.0
"""Longest wait for a result that another process computes, s. That process may have been stopped: after this
time the result is computed here too.
"""
_LOOK_S = 0.05
"""Time between two attempts to get a lock, s."""
NOT_ARRAYS = ("facts", "checksum")
"""Entries of a file that are texts: the plain fields as JSON, and the checksum of all of it."""
Cached = TypeVar("Cached", FlankCompliance, FlankCompliance3D, UnitRootStress)
Result = TypeVar("Result")


@lru_cache(maxsize=1)
def mesher_version() -> str:
    """Return the version of gmsh, which is in every key: its installed files are read once."""
    return version("gmsh")


def content_hash(content: Json) -> str:
    """Return the SHA-256 of plain JSON, hexadecimal, independent of the order of keys."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def cached_or_computed(
    directory: Path | None, key: str, kind: type[Cached], compute: Callable[[], Cached]
) -> Cached:
    """Return the result stored under `key`, or compute and store it; without a directory only compute it.

    Of all processes that share the directory one computes; the others wait for it.
    """
    if directory is None:
        return compute()
    result = read_compliance(directory, key, kind)
    if result is not None:
        return result
    with _alone(directory, key):
        result = _read(directory, key, kind)
        if result is None:
            result = compute()
            write_compliance(directory, key, result)
    return result


@contextmanager
def _alone(directory: Path, key: str) -> Iterator[None]:
    """Hold the lock of a key in the context, so that no other process computes the same.

    After `PATIENCE_S`, or where nothing can be locked, the context begins without the lock. The lock ends
    with its process. Its file is removed before the lock is released: processes that waited then look for the
    result first, and find it.
    """
    file, descriptor, locked = directory / f"compliance-{key}.lock", None, False
    with suppress(OSError):
        directory.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(file, os.O_CREAT | os.O_RDWR, 0o600)
    try:
        locked = descriptor is not None and _locked(descriptor)
        yield
    finally:
        if locked:
            with suppress(OSError):
                file.unlink()
        if descriptor is not None:
            os.close(descriptor)


def _locked(descriptor: int) -> bool:
    """Wait for a lock; return whether this process holds it."""
    deadline = time.monotonic() + PATIENCE_S
    while True:
        try:
            lock(descriptor)
        except BlockingIOError:
            if time.monotonic() > deadline:
                return False
            time.sleep(_LOOK_S)
        except OSError:  # a file system without locks
            return False
        else:
            return True


def computed_once(keys: Sequence[str], compute: Callable[[int], Result]) -> tuple[Result, ...]:
    """Return a result for each key; equal keys share one, computed by the index of the first of them."""
    results: dict[str, Result] = {}
    for number, key in enumerate(keys):
        if key not in results:
            results[key] = compute(number)
    return tuple(results[key] for key in keys)


def read_compliance(directory: Path, key: str, kind: type[Cached]) -> Cached | None:
    """Return the result stored under `key`, or None if there is none or its file is damaged."""
    result = _read(directory, key, kind)
    COMPLIANCE_READS.note(hit=result is not None)
    return result


def _read(directory: Path, key: str, kind: type[Cached]) -> Cached | None:
    """Read the file of a key; raises nothing."""
    try:
        # NumPy leaves a file it opened itself open when the content is damaged.
        with _file(directory, key).open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files if name not in NOT_ARRAYS}
            header = str(file["facts"])
            intact = str(file["checksum"]) == _checksum(arrays, header)
        with suppress(OSError):  # of another owner
            os.utime(_file(directory, key))  # its last use, by which caches are kept small
        return _restored(kind, arrays, json.loads(header)) if intact else None
    # What a truncated, overwritten or foreign file makes NumPy, zipfile, json and the constructors raise.
    except (OSError, EOFError, ValueError, KeyError, TypeError, zipfile.BadZipFile):
        return None


def write_compliance(
    directory: Path, key: str, compliance: FlankCompliance | FlankCompliance3D | UnitRootStress
) -> None:
    """Store a result under `key`; a reader sees the whole file or none.

    Nothing is raised where the directory cannot be written: the caller has the result all the same.
    """
    content = {f.name: getattr(compliance, f.name) for f in fields(compliance) if f.name != "from_cache"}
    arrays = {name: value for name, value in content.items() if isinstance(value, np.ndarray)}
    plain = {name: value for name, value in content.items() if name not in arrays}
    header = json.dumps(plain | {"checks": asdict(compliance.checks)})
    try:
        directory.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=directory, suffix=".partial")
    except OSError:
        return
    try:
        with os.fdopen(handle, "wb") as stream:
            np.savez(stream, allow_pickle=False, facts=header, checksum=_checksum(arrays, header), **arrays)
        Path(name).replace(_file(directory, key))
    except OSError:
        Path(name).unlink(missing_ok=True)


def cached_size(directory: Path | None, key: str) -> int:
    """Return the size of the file under `key` in bytes, 0 if there is none; the file is not checked."""
    if directory is None:
        return 0
    try:
        return _file(directory, key).stat().st_size
    except OSError:
        return 0


def _file(directory: Path, key: str) -> Path:
    return directory / f"compliance-{key}.npz"


def _checksum(arrays: dict[str, np.ndarray[Any, Any]], header: str) -> str:
    digest = hashlib.sha256(header.encode())
    for name, value in arrays.items():
        array = np.ascontiguousarray(value)
        digest.update(f"{name} {array.dtype.str} {array.shape}".encode())
        digest.update(array.data)
    return digest.hexdigest()


def _restored(kind: type[Cached], arrays: dict[str, np.ndarray[Any, Any]], header: Json) -> Cached:
    laws = RootStressChecks if issubclass(kind, UnitRootStress) else ComplianceChecks
    checks = laws(**header.pop("checks"))
    content: dict[str, Any] = arrays | header | {"checks": checks, "from_cache": True}
    return kind(**content)
