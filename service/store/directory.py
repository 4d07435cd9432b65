"""One scheduler per data directory, and its name."""

from __future__ import annotations

import os
import uuid
from pathlib import Path

from host import lock
from host.directories import private
from lineofaction.gearbox.problems import BadInput


class DirectoryLock:
    """An advisory lock on a data directory; the system lifts it when the process dies, however it dies.

    A process that runs jobs takes it: workspaces, logs and memory are one scheduler's. Others need none.
    """

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._descriptor: int | None = None

    def acquire(self) -> None:
        """Take the lock, if it is not ours already.

        Raises
        ------
        BadInput
            The directory cannot be written, or another service works in it.
        """
        if self._descriptor is not None:
            return
        try:
            private(self._directory)
            descriptor = os.open(self._directory / "service.lock", os.O_RDWR | os.O_CREAT, 0o600)
        except OSError as error:
            suggestion = f"{error.strerror}. Choose another with --data-directory."
            raise BadInput.of(
                "data_directory", str(self._directory), "a writable directory", suggestion
            ) from None
        try:
            lock(descriptor)
        except BlockingIOError:
            os.close(descriptor)
            raise BadInput.of(
                "data_directory",
                str(self._directory),
                "free: another service works in it",
                "Stop that service or choose another directory with --data-directory.",
            ) from None
        self._descriptor = descriptor

    def release(self) -> None:
        """Lift the lock."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None


def identity_of(directory: Path) -> str:
    """Return the name of whoever holds the lock of a data directory: the same after a restart."""
    directory.mkdir(parents=True, exist_ok=True)
    file = directory / "service.id"
    if not file.is_file():
        draft = directory / f".service.id.{os.getpid()}"
        draft.write_text(uuid.uuid4().hex, encoding="ascii")
        draft.replace(file)
    return file.read_text(encoding="ascii").strip()
