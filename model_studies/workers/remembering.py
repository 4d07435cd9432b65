"""Workers that store the results of tasks: an interrupted study, repeated, computes the missing ones only."""

from __future__ import annotations

import hashlib
import os
import pickle
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from model_studies.workers.content_digest import content_digest
from model_studies.workers.in_process import Workers
from model_studies.workers.run_cost import RunCost

S = TypeVar("S")
T = TypeVar("T")
R = TypeVar("R")
_CHECKSUM = 32
"""Bytes of a SHA-256 digest, which stands before the content of a file."""


@dataclass(frozen=True)
class Remembering:
    """Workers with a folder that stores their results.

    Files of the folder are unpickled, so it must belong to this study alone. The caller removes it.
    """

    others: Workers
    """Workers that do the tasks without a stored result."""
    folder: Path
    version: str
    """Version of the program; results of another version are not used."""
    _digests: dict[int, tuple[object, str]] = field(default_factory=dict, compare=False, repr=False)
    """Shared objects and their digests by the `id` of the object. The object is in the value so that it lives
    and no other one gets its `id`.
    """

    @property
    def cost(self) -> RunCost:
        """Cost of the tasks that had no stored result."""
        return self.others.cost

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Yield the results of tasks in their order, stored ones or computed ones, which are stored."""
        files = self._files(function, shared, items)
        if files is None:
            yield from self.others.run(function, shared, items)
            return
        stored = [_read(file) for file in files]
        missing = [item for item, known in zip(items, stored, strict=True) if known is None]
        results = self.others.run(function, shared, missing)
        for file, known in zip(files, stored, strict=True):
            if known is not None:  # a tuple of one result, which itself may be None
                yield known[0]
                continue
            result = next(results)
            _write(file, result)
            yield result

    def _files(
        self, function: Callable[..., Any], shared: object, items: Sequence[object]
    ) -> list[Path] | None:
        """Return the files of the results of tasks; None if the content of the tasks cannot be identified."""
        try:
            if id(shared) not in self._digests:
                self._digests[id(shared)] = shared, content_digest(shared)
            _, shared_digest = self._digests[id(shared)]
            context = f"{self.version} {function.__module__}.{function.__qualname__} {shared_digest}"
            names = [f"{context} {content_digest(item)}" for item in items]
        except TypeError:  # `content_digest` knows no digest of such an object
            return None
        return [self.folder / hashlib.sha256(name.encode()).hexdigest() for name in names]


def _write(file: Path, result: Any) -> None:
    """Store a result by a temporary file, so that a reader finds all of it or nothing.

    A file that cannot be written, on a full disk for example, is left out: the result is computed anew.
    """
    content = pickle.dumps(result, protocol=pickle.HIGHEST_PROTOCOL)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=file.parent, suffix=".partial")
        with os.fdopen(handle, "wb") as stream:
            stream.write(hashlib.sha256(content).digest() + content)
        Path(name).replace(file)
    except OSError:
        return


def _read(file: Path) -> tuple[Any] | None:
    """Return a stored result in a tuple; None: it is missing or damaged."""
    try:
        content = file.read_bytes()
    except OSError:
        return None
    if hashlib.sha256(content[_CHECKSUM:]).digest() != content[:_CHECKSUM]:
        return None
    return (pickle.loads(content[_CHECKSUM:]),)
