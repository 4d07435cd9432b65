"""Results cached in files that are named by the content of their inputs."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

Cached = TypeVar("Cached")


def cached_in(
    file: Path | None,
    read: Callable[[Path], Cached],
    make: Callable[[], Cached],
    write: Callable[[Cached, Path], object],
    unreadable: type[Exception],
    keeps: Callable[[Cached], bool] = lambda _made: True,
) -> Cached:
    """Return the content of a cached file; it is made and written where it is absent or damaged.

    A folder that cannot be written is no reason to lose a result.

    Parameters
    ----------
    file : Path or None
        None: neither read nor written.
    read, write : callable
        Of the file.
    make : callable
        Computes the result.
    unreadable : type of Exception
        What `read` raises of a file that is absent or damaged.
    keeps : callable
        Whether a result gets a file.
    """
    if file is None:
        return make()
    if (known := read_cached(file, read, unreadable)) is not None:
        return known
    made = make()
    if keeps(made):
        with suppress(OSError):
            file.parent.mkdir(parents=True, exist_ok=True)
            write(made, file)
    return made


def read_cached(file: Path, read: Callable[[Path], Cached], unreadable: type[Exception]) -> Cached | None:
    """Return what a file keeps, None if it is absent or damaged; parameters as those of `cached_in`."""
    with suppress(unreadable):
        result = read(file)
        with suppress(OSError):  # of another owner
            os.utime(file)  # its last use, by which caches are kept small
        return result
    return None
