"""Tasks whose results are kept until all is done: an interrupted study goes on where it was."""

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


@dataclass(frozen=True)
class Remembering:
    """Workers with a folder that stores their results.

    The folder is of this study alone, as its files are unpickled, and the caller's to remove. Results of
    another `version` of what computes are not taken.
    """

    others: Workers
    folder: Path
    version: str
    _digests: dict[int, tuple[object, str]] = field(default_factory=dict, compare=False, repr=False)

    @property
    def cost(self) -> RunCost:
        """Cost of the tasks that the other workers did this time."""
        return self.others.cost

    def run(self, function: Callable[[S, T], R], shared: S, items: Sequence[T]) -> Iterator[R]:
        """Yield stored results and new ones; the new ones are stored."""
        files = self._files(function, shared, items)
        if files is None:
            yield from self.others.run(function, shared, items)
            return
        stored = [_read(file) for file in files]
        missing = [item for item, known in zip(items, stored, strict=True) if known is None]
        results = self.others.run(function, shared, missing)
        for file, known in zip(files, stored, strict=True):
            if known is not None:
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
            known = self._digests.get(id(shared))
            if known is None:
                known = self._digests[id(shared)] = shared, content_digest(shared)
            context = f"{self.version} {function.__module__}.{function.__qualname__} {known[1]}"
            names = [f"{context} {content_digest(item)}" for item in items]
        except TypeError:
            return None
        return [self.folder / hashlib.sha256(name.encode()).hexdigest() for name in names]


def _write(file: Path, result: Any) -> None:
    """Keep a result; a reader sees all of it or nothing, and no room for it is no reason to fail."""
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
    try:
        content = file.read_bytes()
    except OSError:
        return None
    if hashlib.sha256(content[_CHECKSUM:]).digest() != content[:_CHECKSUM]:
        return None
    return (pickle.loads(content[_CHECKSUM:]),)
