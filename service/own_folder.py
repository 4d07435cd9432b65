"""Folders that a process uses for a while, and that are removed however it ends."""

from __future__ import annotations

import os
import shutil
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from host import lock


@contextmanager
def own_folder(home: Path) -> Iterator[Path]:
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
    """Remove folders below another that processes left which the system or somebody killed."""
    for folder in home.iterdir() if home.is_dir() else ():
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            lock(descriptor)
            shutil.rmtree(folder, ignore_errors=True)
        except BlockingIOError:  # of a process that lives: several share a data directory
            pass
        finally:
            os.close(descriptor)
