"""Folders: the data directory and its one server, those of a process alone, those of limited size."""

from __future__ import annotations

import contextlib
import os
import shutil
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from host import lock
from host.directories import private
from lineofaction.gearbox.problems import BadInput

IN_USE_S = 600.0
"""A file that was used so recently stays: somebody may be reading it."""
DEFAULT_BYTES = 2_000_000_000


def locked(path: Path, flags: int = os.O_RDWR | os.O_CREAT) -> int | None:
    """Open a file or folder and lock it as long as it is open; None: another process has."""
    descriptor = os.open(path, flags, 0o600)
    try:
        lock(descriptor)
    except BlockingIOError:
        os.close(descriptor)
        return None
    return descriptor


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
        descriptor = locked(folder, os.O_RDONLY)
        if descriptor is not None:  # of no process that lives: several share a data directory
            shutil.rmtree(folder, ignore_errors=True)
            os.close(descriptor)


# How much a folder of files that can be made again holds, and what goes first when it is too much.


@dataclass(frozen=True, order=True)
class UsedFile:
    """A file by its last use, s since the epoch; reading it sets the time of its last change."""

    used: float
    size: int
    path: Path


def files_in(folder: Path) -> list[UsedFile]:
    """Return the files below a folder, the one that was not used for longest first."""
    return sorted(_files(folder))


def evict(folder: Path, most_bytes: int, in_use_s: float = IN_USE_S) -> list[UsedFile]:
    """Remove what was not used for longest until the rest fits, and return it; what is in use stays."""
    files = files_in(folder)
    excess = sum(file.size for file in files) - most_bytes
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
                facts = path.stat()
                yield UsedFile(facts.st_mtime, facts.st_size, path)


# One server per data directory.


class DirectoryLock:
    """An advisory lock on a data directory; the system lifts it when the process dies, however it dies.

    A process that runs jobs takes it: workspaces, logs and memory are its own. Others need none.
    """

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._descriptor: int | None = None

    def acquire(self) -> None:
        """Take the lock, if it is not ours already.

        Raises `BadInput`: the directory cannot be written, or another service works in it.
        """
        if self._descriptor is not None:
            return
        try:
            private(self._directory)
            self._descriptor = locked(self._directory / "service.lock")
        except OSError as error:
            suggestion = f"{error.strerror}. Choose another with --data-directory."
            raise BadInput.of(
                "data_directory", str(self._directory), "a writable directory", suggestion
            ) from None
        if self._descriptor is None:
            raise BadInput.of(
                "data_directory",
                str(self._directory),
                "free: another service works in it",
                "Stop that service or choose another directory with --data-directory.",
            )

    def release(self) -> None:
        """Lift the lock."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None
