"""Limit on the size of a folder of files that can be made again: the longest unused go first."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

IN_USE_S = 600.0
"""A file that was used so recently stays: somebody may be reading it."""
DEFAULT_BYTES = 2_000_000_000


@dataclass(frozen=True, order=True)
class UsedFile:
    """A file with its last use, s since the epoch: the time of its last change, which readers set."""

    used: float
    size: int
    path: Path


def files_in(folder: Path) -> list[UsedFile]:
    """Return the files below a folder, the one that was not used for longest first."""
    return sorted(_files(folder))


def evict(folder: Path, max_bytes: int, in_use_s: float = IN_USE_S) -> list[UsedFile]:
    """Remove the longest unused files until the rest fits, and return them; files in use stay."""
    files = files_in(folder)
    excess = sum(file.size for file in files) - max_bytes
    removed = []
    for file in files:
        if excess <= 0 or time.time() - file.used < in_use_s:
            break
        file.path.unlink(missing_ok=True)
        excess -= file.size
        removed.append(file)
    return removed


def _files(folder: Path) -> Iterator[UsedFile]:
    for path in folder.rglob("*"):
        with contextlib.suppress(FileNotFoundError):  # another process was quicker
            if path.is_file():
                status = path.stat()
                yield UsedFile(status.st_mtime, status.st_size, path)
