"""States of a long run on disk: a file that only grows, and the checkpoint that says how much of it counts.

A process that is killed while it writes leaves bytes behind the last checkpoint; they are cut off when the
run is taken up again. A netCDF file could be left unreadable by the same; it is written when the run has
ended.
"""

from __future__ import annotations

import fcntl
import os
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

import numpy as np

from dynamics.errors import InputError, ResultError
from dynamics.integrators.checkpoint import Arrays, read_checkpoint, write_checkpoint
from dynamics.integrators.state_sink import States
from dynamics.types import FloatArray


class StateSpool:
    """A `StateSink` in two files: `path`.states and `path`.checkpoint.

    A record is q, v and `moved` of one sample, 8 bytes each.
    """

    def __init__(self, path: Path, freedoms: int, laws: int) -> None:
        self._checkpoint = path.with_name(f"{path.name}.checkpoint")
        self._freedoms, self._laws = freedoms, laws
        self._room = self._rows(0)
        states = path.with_name(f"{path.name}.states")
        states.touch()
        self._file: BinaryIO = states.open("r+b")
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self._file.close()
            raise InputError("output", str(path), "free: another process runs this") from None

    def __enter__(self) -> StateSpool:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()

    @property
    def _record(self) -> int:
        """Columns of a record."""
        return 2 * self._freedoms + self._laws

    def room(self, first: int, count: int) -> States:
        """Return rows that are used again for the next room."""
        if self._room.q.shape[0] < count:
            self._room = self._rows(count)
        return self._room.rows(0, count)

    def _rows(self, count: int) -> States:
        """Allocate."""
        shape = (count, self._freedoms)
        return States(np.zeros(shape), np.zeros(shape), np.zeros((count, self._laws), dtype=np.int64))

    def keep(self, first: int, count: int) -> None:
        """Append."""
        kept = self._room.rows(0, count)
        self._file.seek(8 * self._record * first)
        self._file.write(np.hstack([kept.q, kept.v, kept.moved.view(np.float64)]).tobytes())

    def states(self, first: int, stop: int) -> States:
        """Read the records back."""
        self._file.seek(8 * self._record * first)
        content = self._file.read(8 * self._record * (stop - first))
        table: FloatArray = np.frombuffer(content).reshape(stop - first, self._record)
        n = self._freedoms
        q, v, moved = (np.ascontiguousarray(part) for part in np.split(table, (n, 2 * n), axis=1))
        return States(q, v, moved.view(np.int64))

    def save(self, state: Any, **facts: Any) -> None:
        """Make all that was kept durable, then write a checkpoint that counts on it."""
        self._file.flush()
        os.fsync(self._file.fileno())
        write_checkpoint(self._checkpoint, state, **facts)

    def begin(self) -> None:
        """Forget whatever is there."""
        self._checkpoint.unlink(missing_ok=True)
        self._file.truncate(0)

    def resume(self, samples: int) -> None:
        """Cut off what came after the checkpoint.

        Raises
        ------
        ResultError
            If there is less than that many samples.
        """
        size = 8 * self._record * samples
        if os.fstat(self._file.fileno()).st_size < size:
            raise ResultError(f"{self._file.name}: shorter than its checkpoint says. Start the run anew.")
        self._file.truncate(size)

    def checkpoint(self) -> tuple[Arrays, Arrays] | None:
        """Return arrays and facts of the last checkpoint, if there is one."""
        return read_checkpoint(self._checkpoint) if self._checkpoint.is_file() else None
