"""A march that goes on where another one, of fewer force elements, stood."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dynamics.integrators.march import March
from dynamics.integrators.state_sink import States, StateSink, blocks
from dynamics.integrators.workspace import Count, Workspace
from dynamics.system.assemble import System
from dynamics.system.observation import local_state
from dynamics.types import FloatArray, IntArray

STATE = ("time", "time_rest", "error", "q", "v", "v_rest", "a", "moved", "power", "work", "counts")
"""What a workspace carries from step to step beside what is per row of the force elements."""
MOTION = ("position", "pace", "speed")


@dataclass(frozen=True)
class Stand:
    """Where a march stood between two steps.

    Attributes
    ----------
    state : dict of str to array
        Fields `STATE` of its workspace.
    motion : dict of str to array
        `position`, `pace` and `speed` at the last step's end.
    force, coordinate, rate : (R,) arrays
        Local forces, coordinates and rates there.
    """

    state: dict[str, FloatArray]
    motion: dict[str, FloatArray]
    force: FloatArray
    coordinate: FloatArray
    rate: FloatArray

    @property
    def time(self) -> float:
        """Of the last step's end, s."""
        return float(self.state["time"][0])

    @property
    def samples(self) -> int:
        """Output samples so far."""
        return int(self.state["counts"][Count.OUTPUT])


def stand(work: Workspace) -> Stand:
    """Return where `work` stands, copied."""
    state = {name: np.array(getattr(work, name)) for name in STATE}
    motion = {name: np.array(getattr(work.before, name)) for name in MOTION}
    rows = (work.force, work.before.coordinate, work.before.rate)
    return Stand(state, motion, *(np.array(part) for part in rows))


class Trail:
    """The stands of a march of `system` after its blocks."""

    def __init__(self, system: System) -> None:
        self.system = system
        self._stands: list[Stand] = []

    def watch(self, march: March) -> Callable[[], None]:
        """Return what remembers a stand of `march` when called."""
        return lambda: self._stands.append(stand(march.work))

    def before(self, time: float) -> Stand | None:
        """Return the last stand before `time` (s), if there is one."""
        return next((one for one in reversed(self._stands) if one.time < time), None)


@dataclass(frozen=True)
class Taken:
    """Where a march begins that goes on for another one.

    Attributes
    ----------
    at : Stand
    place : (R,) int array
        See `added_rows`.
    states : callable
        Gives the other march's output samples from one to before another.
    """

    at: Stand
    place: IntArray
    states: Callable[[int, int], States]

    def into(self, march: March, sink: StateSink) -> None:
        """Let `march` stand there, and `sink` hold the samples before it."""
        take_over(march, self.at, self.place)
        for first, stop in blocks(self.at.samples):
            room = sink.room(first, stop - first)
            for target, values in zip(room, self.states(first, stop), strict=True):
                target[...] = values
            sink.keep(first, stop - first)


def added_rows(before: System, after: System) -> IntArray | None:
    """Return the place (R,) of each row of `before` among those of `after`; None if one has no place there.

    Rows match if they are of one law and direction, in one order.
    """
    if before.freedoms.name != after.freedoms.name:
        return None
    place, start = [], 0
    there = _rows(after)
    for row in _rows(before):
        found = next((k for k in range(start, len(there)) if there[k] == row), None)
        if found is None:
            return None
        place.append(found)
        start = found + 1
    return np.array(place, dtype=np.int64)


def _rows(system: System) -> list[tuple[int, bytes]]:
    """Law and direction of every row."""
    elements = system.arrays.elements
    law = np.repeat(elements.law, np.diff(elements.first))
    return [(int(kind), row.tobytes()) for kind, row in zip(law, system.arrays.direction, strict=True)]


def take_over(march: March, at: Stand, place: IntArray) -> None:
    """Let `march`, of the same freedoms, stand where another one stood: `place` (R,) are its rows.

    Elements that it has beside those of the other one carry no force there.
    """
    work, arrays = march.work, march.system.arrays
    for name, values in at.state.items():
        getattr(work, name)[...] = values
    here = local_state(arrays, at.time, work.q, work.v, work.moved)
    before = work.before
    for name, values in at.motion.items():
        getattr(before, name)[...] = values
    for target, values, known in (
        (work.force, np.zeros(work.force.size), at.force),
        (before.coordinate, here.coordinate, at.coordinate),
        (before.rate, here.rate, at.rate),
    ):
        target[...] = values
        target[place] = known
