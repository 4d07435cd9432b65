"""The samples of a run: states, and the channels of the anti-alias filter.

Channels are local forces, displacements and rates that the anti-alias filter takes (`SampleRing`). A free
train has no drive; its rotation moves from its freedom into the kinematic motion in quanta.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.types import FloatArray, IntArray


class States(NamedTuple):
    """Sampled states: n freedoms, k laws, R local forces, C channels (see `SampleRing`)."""

    q: FloatArray
    v: FloatArray
    """`q`, `v`: Deviations from the kinematic motion and their rates; without the amplitudes of housings
    where no output has them. Shape (T, n) each.
    """
    carried: FloatArray
    """Local coordinates, then their rates, of the rows that these amplitudes move; s = 0 where `q` has them.
    Shape (T, 2 s).
    """
    quanta: IntArray
    """Quanta of a revolution by which each free train's own rotation was moved into the kinematic motion.
    Shape (T, k).
    """
    filtered: FloatArray
    """All channels behind the anti-alias filter. Shape (T, C)."""
    minimum: FloatArray
    largest: FloatArray
    """`minimum`, `largest`: Extremes (T, R) of the local forces between the samples, unfiltered."""

    def rows(self, first: int, stop: int) -> States:
        """Return a view of the samples `first` to `stop` - 1."""
        part = slice(first, stop)
        state = self.q[part], self.v[part], self.carried[part], self.quanta[part]
        return States(*state, self.filtered[part], self.minimum[part], self.largest[part])


class Widths(NamedTuple):
    """Numbers of freedoms, carried signals, laws, channels and local forces of `States`."""

    freedoms: int
    carried: int
    laws: int
    channels: int
    rows: int

    def states(self, samples: int) -> States:
        """Allocate."""
        return States(
            np.zeros((samples, self.freedoms)),
            np.zeros((samples, self.freedoms)),
            np.zeros((samples, self.carried)),
            np.zeros((samples, self.laws), dtype=np.int64),
            np.zeros((samples, self.channels)),
            np.zeros((samples, self.rows)),
            np.zeros((samples, self.rows)),
        )
