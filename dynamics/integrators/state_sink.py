"""The sink of the sampled states of a run: one protocol, in memory or on disk with checkpoints.

A state holds displacements and rates of the freedoms, and filtered channels (`States`).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, Protocol

import numpy as np

from dynamics.errors import InputError, ResultError
from dynamics.integrators.checkpoints import Arrays, read_checkpoint, write_checkpoint
from dynamics.motion.sampled_states import States, Widths
from dynamics.types import FloatArray
from host import lock

BLOCK = 8192
"""Samples that are in memory at once where a run is streamed, and that series are made of at once always, so
that both ways give the same bits."""


class StateSink(Protocol):
    """Takes samples in order, and gives them back."""

    def room(self, first: int, count: int) -> States:
        """Return zeroed or unwritten rows for the samples `first` to `first + count` - 1."""

    def keep(self, first: int, count: int) -> None:
        """Keep the first `count` rows of the room last given, which started at sample `first`."""

    def states(self, first: int, stop: int) -> States:
        """Return the samples `first` to `stop` - 1."""


class MemorySink:
    """All samples in arrays made once."""

    def __init__(self, samples: int, widths: Widths) -> None:
        self.all = widths.states(samples)

    def room(self, first: int, count: int) -> States:
        """Return a view of the rows."""
        return self.states(first, first + count)

    def keep(self, first: int, count: int) -> None:
        """Do nothing: the rows were written in place."""

    def states(self, first: int, stop: int) -> States:
        """Return a view of the rows."""
        return self.all.rows(first, stop)


def blocks(samples: int) -> Iterator[tuple[int, int]]:
    """Yield first and last + 1 of the blocks of a run with that many samples."""
    for first in range(0, samples, BLOCK):
        yield first, min(first + BLOCK, samples)


class StateSpool:
    """A `StateSink` in two files: `path`.states and `path`.checkpoint.

    A record is one sample of all parts of `States`, 8 bytes each.
    """

    def __init__(self, path: Path, widths: Widths) -> None:
        self._checkpoint = path.with_name(f"{path.name}.checkpoint")
        self.widths, self._room = widths, widths.states(0)
        states = path.with_name(f"{path.name}.states")
        states.touch()
        self._file: BinaryIO = states.open("r+b")
        try:
            lock(self._file.fileno())
        except BlockingIOError:
            self._file.close()
            raise InputError("output", path.name, "free: another process runs this") from None

    def __enter__(self) -> StateSpool:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()

    @property
    def _record(self) -> int:
        return sum(part.shape[1] for part in self._room)

    def room(self, first: int, count: int) -> States:
        """Return rows that are used again for the next room."""
        if self._room.q.shape[0] < count:
            self._room = self.widths.states(count)
        return self._room.rows(0, count)

    def keep(self, first: int, count: int) -> None:
        """Append."""
        rows = self._room.rows(0, count)
        self._file.seek(8 * self._record * first)
        self._file.write(np.hstack([part.view(np.float64) for part in rows]).tobytes())

    def states(self, first: int, stop: int) -> States:
        """Read the records back."""
        return self._read(self.widths, first, stop)

    def _read(self, widths: Widths, first: int, stop: int) -> States:
        parts = widths.states(0)
        columns = [part.shape[1] for part in parts]
        record = sum(columns)
        self._file.seek(8 * record * first)
        content = self._file.read(8 * record * (stop - first))
        table: FloatArray = np.frombuffer(content).reshape(stop - first, record)
        q, v, carried, quanta, *rest = (
            np.ascontiguousarray(part) for part in np.split(table, np.cumsum(columns)[:-1], axis=1)
        )
        return States(q, v, carried, quanta.view(np.int64), *rest)

    def rewrite(self, before: Widths, samples: int, convert: Callable[[States], States]) -> None:
        """Replace `samples` records of the narrower widths `before` by their conversion.

        From the last block to the first: a wider record never reaches a narrower one that is still to come.
        """
        for first, stop in reversed(list(blocks(samples))):
            converted = convert(self._read(before, first, stop))
            for target, values in zip(self.room(first, stop - first), converted, strict=True):
                target[...] = values
            self.keep(first, stop - first)

    def save(self, state: Any, **values: Any) -> None:
        """Make all that was kept durable, then write a checkpoint that counts on it."""
        self._file.flush()
        os.fsync(self._file.fileno())
        write_checkpoint(self._checkpoint, state, **values)

    def begin(self) -> None:
        """Forget all records."""
        self._checkpoint.unlink(missing_ok=True)
        self._file.truncate(0)

    def resume(self, samples: int) -> None:
        """Cut off the records after the checkpoint.

        Raises
        ------
        ResultError
            If there is less than that many samples.
        """
        size = 8 * self._record * samples
        if os.fstat(self._file.fileno()).st_size < size:
            raise ResultError(f"{self._file.name}: shorter than its checkpoint says. Start a new run.")
        self._file.truncate(size)

    def checkpoint(self) -> tuple[Arrays, Arrays] | None:
        """Return arrays and facts of the last checkpoint, if there is one."""
        return read_checkpoint(self._checkpoint) if self._checkpoint.is_file() else None
