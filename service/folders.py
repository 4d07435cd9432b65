"""Folders that one process has to itself: locked as long as it lives, removed when it is gone."""

from __future__ import annotations

import os
import shutil
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from host import lock


def locked(path: Path, flags: int = os.O_RDWR | os.O_CREAT) -> int | None:
    """Open a file or folder, lock it and return the descriptor; None: another process has the lock."""
    descriptor = os.open(path, flags, 0o600)
    try:
        lock(descriptor)
    except BlockingIOError:
        os.close(descriptor)
        return None
    return descriptor


@contextmanager
def locked_folder(home: Path) -> Iterator[Path]:
    """Make a folder below another and remove it at the end; it is locked until then."""
    folder = home / uuid.uuid4().hex
    folder.mkdir(mode=0o700, parents=True)
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        lock(descriptor)
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(descriptor)


def remove_left(home: Path) -> None:
    """Remove folders below `home` whose processes were killed and could not remove them."""
    for folder in home.iterdir() if home.is_dir() else ():
        descriptor = locked(folder, os.O_RDONLY)
        if descriptor is not None:  # no living process has it: several may share a data directory
            shutil.rmtree(folder, ignore_errors=True)
            os.close(descriptor)
