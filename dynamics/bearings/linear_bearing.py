"""A linear bearing in a housing that moves, as a force element; its compiled law.

On rigid ground such a bearing is entries of stiffness and damping. In a housing it would couple all modes of
the housing with each other; as an element of a few rows it leaves them apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.types import FloatArray, IntArray

MAX = 5  # most rows of a linear bearing


class LinearBearingLaws(NamedTuple):
    """l bearings F = K y + C y' of n rows."""

    size: IntArray
    """n, up to 5. Shape (l,)."""
    stiffness: FloatArray
    damping: FloatArray
    """`stiffness`, `damping`: Stiffness, N/m, and damping, N s/m; symmetric, positive semidefinite. Shape
    (l, 5, 5) each.
    """

    @classmethod
    def packed(cls, laws: Sequence[tuple[FloatArray, FloatArray]]) -> LinearBearingLaws:
        """Lay out the stiffness and the damping (n, n) of each bearing."""
        stiffness, damping = np.zeros((2, len(laws), MAX, MAX))
        for entry, (spring, damper) in enumerate(laws):
            rows = len(spring)
            stiffness[entry, :rows, :rows], damping[entry, :rows, :rows] = spring, damper
        return cls(np.array([len(spring) for spring, _ in laws], dtype=np.int64), stiffness, damping)


@routine
def linear_bearing(laws: LinearBearingLaws, entry: int, local: LocalState, row: int) -> None:
    """Write forces and derivatives into the rows of a bearing, the first of which is `row`."""
    n = laws.size[entry]
    for i in range(n):
        elastic, viscous = 0.0, 0.0
        for j in range(n):
            spring, damper = laws.stiffness[entry, i, j], laws.damping[entry, i, j]
            elastic += spring * local.coordinate[row + j]
            viscous += damper * local.rate[row + j]
            local.tangent[row + i, j], local.viscous[row + i, j] = spring, damper
        local.elastic[row + i], local.force[row + i] = elastic, elastic + viscous


@routine
def linear_bearing_energy(laws: LinearBearingLaws, entry: int, local: LocalState, row: int) -> float:
    """Return the energy stored, J."""
    energy = 0.0
    for i in range(laws.size[entry]):
        for j in range(laws.size[entry]):
            pull = laws.stiffness[entry, i, j] * local.coordinate[row + j]
            energy += 0.5 * local.coordinate[row + i] * pull
    return energy
