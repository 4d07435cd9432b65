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
    """Return what a file keeps; None where it is absent or damaged, or there is no file.

    Parameters
    ----------
    file : Path or None
        None: nothing is kept.
    read : callable
        Of the file.
    unreadable : type of Exception
        What `read` raises of a file that is absent or damaged.
    """
    if file is None:
        return None
    with suppress(unreadable):
        result = read(file)
        with suppress(OSError):  # of another owner
            os.utime(file)  # its last use, by which caches are kept small
        return result
    return None


def keep_cached(result: Cached, file: Path | None, write: Callable[[Cached, Path], object]) -> None:
    """Write a result into its file; a folder that cannot be written is no reason to lose it.

    Parameters
    ----------
    file : Path or None
        None: it is not kept.
    write : callable
        Of the result, into the file.
    """
    if file is None:
        return
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        write(result, file)
