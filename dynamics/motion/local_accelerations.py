"""Accelerations of local coordinates, for the laws that depend on them: unbalances."""

from __future__ import annotations

from dynamics.arrays.arrays import SystemArrays
from dynamics.arrays.sparse_rows import row_product
from dynamics.forces.elements import UNBALANCE
from dynamics.kernels.compiled import inner
from dynamics.kernels.local_state import LocalState
from dynamics.loads.unbalance_law import unbalance
from dynamics.motion.motion import ACCELERATION
from dynamics.types import FloatArray

ITERATIONS = 30
"""Most iterations.

Each multiplies the error by the distance of the center of mass from the axis over the radius of gyration.
"""


SETTLED = 1e-14
"""Change of the forces in the last iteration, over the forces."""


@inner
def set_acceleration(
    system: SystemArrays, motion: FloatArray, acceleration: FloatArray, target: FloatArray
) -> None:
    """Write accelerations of the local coordinates by q'' (n,), and by the kinematic motion, (R,), m/s^2."""
    direction, drift = system.sparse.direction, system.elements.drift
    for r in range(target.size):
        target[r] = row_product(direction, direction.weight, r, acceleration)
        for k in range(motion.shape[0]):
            target[r] += drift[k, r] * motion[k, ACCELERATION]


@inner
def settle_unbalance(
    system: SystemArrays,
    motion: FloatArray,
    local: LocalState,
    external: FloatArray,
    acceleration: FloatArray,
) -> None:
    """Make unbalances and the accelerations q'' (n,) that they depend on agree.

    `external` (n,) are all forces, with those of the elements in ``local.force``, and `acceleration` is the
    acceleration by them; both are updated.
    """
    elements, sparse = system.elements, system.sparse
    for _ in range(ITERATIONS):
        set_acceleration(system, motion, acceleration, local.acceleration)
        change, size = 0.0, 0.0
        for e in range(elements.law.size):
            if elements.law[e] != UNBALANCE:
                continue
            first, end = elements.first[e], elements.first[e + 1]
            for r in range(first, end):
                _add_row(system, r, local.force[r], external)
            before = local.force[first], local.force[first + 1], local.force[first + 2]
            unbalance(elements.laws.unbalance, elements.entry[e], local, first)
            for r in range(first, end):
                _add_row(system, r, -local.force[r], external)
                change = max(change, abs(local.force[r] - before[r - first]))
                size = max(size, abs(local.force[r]))
        for i in range(acceleration.size):
            acceleration[i] = row_product(sparse.mobility, sparse.mobility.weight, i, external)
        if change <= SETTLED * size:
            break


@inner
def _add_row(system: SystemArrays, row: int, force: float, external: FloatArray) -> None:
    direction = system.sparse.direction
    for entry in range(direction.first[row], direction.first[row + 1]):
        external[direction.column[entry]] += direction.weight[entry] * force
