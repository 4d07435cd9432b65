"""The lock by which one server at a time works in a data directory."""

from __future__ import annotations

import os
from pathlib import Path

from host.directories import private
from lineofaction.gearbox.problems import BadInput
from service.folders import locked


class DirectoryLock:
    """An advisory lock on a data directory; the system lifts it when the process dies, however it dies.

    A process that runs jobs takes it, since workspaces, logs and memory must be its own. Others need no lock.
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
