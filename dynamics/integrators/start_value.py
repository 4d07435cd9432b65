"""The start value of a march: the state of another one with fewer force elements.

A run that violates an assumption is repeated with the missing effect on. The repetition starts from the last
state before the violation; the force elements of the effect exert no force until then.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.integrators.march import March
from dynamics.integrators.sampler import SampleRing
from dynamics.integrators.state_sink import StateSink, blocks
from dynamics.integrators.workspace import Count
from dynamics.motion.sampled_states import States
from dynamics.types import FloatArray, IntArray

STATE = (
    *("time", "time_rest", "error", "q", "v", "v_rest", "a", "quanta"),
    *("speed", "power", "work", "highest", "fallen", "counts"),
)
"""Fields of a workspace that go from step to step, except those per row of the force elements."""
MAX_SAVED = 128
"""Most states in memory at once. When there are as many, every second one is dropped."""


@dataclass(frozen=True)
class _SavedState:
    """State of a march between two steps."""

    state: dict[str, FloatArray]
    """Fields `STATE` of the workspace."""
    force: FloatArray
    """Local forces at the last step's end. Shape (R,)."""
    point: FloatArray
    """Points of the sample ring. Shape (L, C)."""
    figures: tuple[FloatArray, ...]
    """Running figures of the sample ring: the last two values, peaks and squares (..., P), sums (R,)."""
    modal_states: FloatArray
    """Modal states of the sample ring. Shape (W, 2, b)."""

    @property
    def time(self) -> float:
        """Time of the last step's end, s."""
        return float(self.state["time"][0])

    @property
    def samples(self) -> int:
        """Number of output samples before the state."""
        return int(self.state["counts"][Count.OUTPUT])


def _saved_state(march: March) -> _SavedState:
    work, ring = march.state
    state = {name: np.array(getattr(work, name)) for name in STATE}
    figures = tuple(part.copy() for part in _figures(ring))
    return _SavedState(state, work.force.copy(), ring.point.copy(), figures, ring.modal_states.copy())


def _figures(ring: SampleRing) -> tuple[FloatArray, ...]:
    return (ring.peaks.last, ring.peaks.largest, ring.peaks.square, ring.removed, ring.folded)


class Trail:
    """The saved states of a march of `system` after its blocks; `taken`: the start of another run."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.taken: StartValue | None = None
        self._saved: list[_SavedState] = []

    def watch(self, march: March) -> Callable[[], None]:
        """Return a function that saves the state of `march`."""

        def remember() -> None:
            if len(self._saved) == MAX_SAVED:
                del self._saved[::2]
            self._saved.append(_saved_state(march))

        return remember

    def before(self, time: float) -> _SavedState | None:
        """Return the last saved state before `time` (s), if there is one."""
        return next((state for state in reversed(self._saved) if state.time < time), None)


@dataclass(frozen=True)
class StartValue:
    """Start value of a march that continues another one."""

    at: _SavedState
    rows_of: IntArray
    """See `added_rows`. Shape (R,)."""
    states: Callable[[int, int], States]
    """Gives the other march's output samples from one to before another."""

    def into(self, march: March, sink: StateSink) -> None:
        """Start `march` from the saved state; `sink` gets the samples before it."""
        self.start(march)
        for first, stop in blocks(self.at.samples):
            room = sink.room(first, stop - first)
            for target, values in zip(room, self.widened(self.states(first, stop), march), strict=True):
                target[...] = values
            sink.keep(first, stop - first)

    def widened(self, states: States, march: March) -> States:
        """Return samples of the other march as those of `march`, whose further elements exert no force."""
        rows = march.ring.local.force.size
        to, width = self._channels(march), states.filtered.shape[1]
        filtered = np.zeros((states.q.shape[0], march.sampler.filtered))
        filtered[:, to[:width]] = states.filtered
        minimum, largest = (np.zeros((states.q.shape[0], rows)) for _ in range(2))
        minimum[:, self.rows_of], largest[:, self.rows_of] = states.minimum, states.largest
        return states._replace(filtered=filtered, minimum=minimum, largest=largest)

    def start(self, march: March) -> None:
        """Start `march` from the saved state; its further elements exert no force."""
        work, at = march.work, self.at
        for name, values in at.state.items():
            getattr(work, name)[...] = values
        work.force[...] = 0.0
        work.force[self.rows_of] = at.force
        self._fill_ring(march)

    def _fill_ring(self, march: March) -> None:
        ring, rows, sampled_rows = march.ring, march.ring.local.force.size, self.rows_of
        ring.point[...] = 0.0
        ring.point[:, self._channels(march)] = self.at.point
        ring.modal_states[...] = self.at.modal_states
        supports = np.arange(rows, ring.peaks.largest.size)
        signals = np.concatenate([sampled_rows, supports])
        columns = (signals, signals, signals, sampled_rows, sampled_rows)
        for target, known, to in zip(_figures(ring), self.at.figures, columns, strict=True):
            target[...] = 0.0
            target[..., to] = known

    def _channels(self, march: March) -> IntArray:
        """Return the channels of `march` that hold the channels of the other march."""
        rows, channels = march.ring.local.force.size, march.ring.point.shape[1]
        return np.concatenate([self.rows_of, np.arange(rows, channels)])


def added_rows(before: System, after: System) -> IntArray | None:
    """Return the index (R,) of each row of `before` among those of `after`; None if one is missing there.

    Rows match if they are of one law and direction, in one order.
    """
    if before.freedoms.name != after.freedoms.name or before.sampling != after.sampling:
        return None
    rows_of, start = [], 0
    rows_after = _rows(after)
    for row in _rows(before):
        index = next((k for k in range(start, len(rows_after)) if rows_after[k] == row), None)
        if index is None:
            return None
        rows_of.append(index)
        start = index + 1
    return np.array(rows_of, dtype=np.int64)


def _rows(system: System) -> list[tuple[int, bytes]]:
    elements = system.arrays.elements
    law = np.repeat(elements.law, np.diff(elements.first))
    return [(int(kind), row.tobytes()) for kind, row in zip(law, system.arrays.direction, strict=True)]
