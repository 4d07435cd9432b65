"""Results cached in files that are named by the content of their inputs."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

Cached = TypeVar("Cached")


def read_cached(
    file: Path | None, read: Callable[[Path], Cached], unreadable: type[Exception]
) -> Cached | None:
    """Return the result in a cache file, None without a file or where it is absent or damaged.

    Parameters
    ----------
    file : Path or None
        Cache file; None: there is no cache.
    read : callable
        Reads the result from the file.
    unreadable : type of Exception
        What `read` raises if the file is absent or damaged.
    """
    if file is None:
        return None
    with suppress(unreadable):
        result = read(file)
        with suppress(OSError):  # the file belongs to another user
            os.utime(file)  # time of last use: a cache that grows too large drops the oldest files
        return result
    return None


def keep_cached(result: Cached, file: Path | None, write: Callable[[Cached, Path], object]) -> None:
    """Write a result into its cache file, if the folder can be written.

    Parameters
    ----------
    file : Path or None
        Cache file; None: there is no cache.
    write : callable
        Writes the result into the file.
    """
    if file is None:
        return
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        write(result, file)
