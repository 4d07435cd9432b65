"""The sink of the sampled states of a run: one protocol, in memory or (`StateSpool`) on disk."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

from dynamics.motion.sampled_states import States, Widths

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
