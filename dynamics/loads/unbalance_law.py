"""The compiled law of unbalances: inertia and weight of a mass off the axis."""

from __future__ import annotations

import math
from typing import NamedTuple

from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.types import BoolArray, FloatArray, IntArray


class UnbalanceLaws(NamedTuple):
    """l unbalances in y = (x, y, lever times the rotation) of the shaft's section.

    With the angle a of the heavy spot from +x, kinetic and potential energy have the terms

        T = U a' (-x' sin a + y' cos a),    V = -U (g_x cos a + g_y sin a),

    from which by Lagrange, with all rotation of the shaft in a, follow the forces

        F_x = U (a'^2 cos a + a'' sin a),   F_y = U (a'^2 sin a - a'' cos a),
        M = U (x'' sin a - y'' cos a + g_y cos a - g_x sin a).
    """

    amount: FloatArray
    angle: FloatArray
    lever: FloatArray
    """`amount`, `angle`, `lever`: U, kg m; a at the phase 0, rad; row over rotation, m. Shape (l,) each."""
    phase: IntArray
    """The phase of the shaft's rotation among the positions. Shape (l,)."""
    gravity: FloatArray
    """g, m/s^2. Shape (2,)."""
    steady: BoolArray
    """Whether only the mean force over a turn acts, which is 0. Shape (1,)."""


@routine
def unbalance(laws: UnbalanceLaws, entry: int, local: LocalState, row: int) -> None:
    """Write forces and their derivatives in rates and accelerations; forces resist, as those of all elements.

    The derivative in the angle is left out: the phase among the positions turns the forces.
    """
    rate, acceleration, lever = local.rate, local.acceleration, laws.lever[entry]
    amount = 0.0 if laws.steady[0] else laws.amount[entry]
    angle = laws.angle[entry] + 2.0 * math.pi * local.position[laws.phase[entry]]
    c, s = amount * math.cos(angle), amount * math.sin(angle)
    spin = (rate[row + 2] + local.drift[row + 2]) / lever
    spin_rate = acceleration[row + 2] / lever
    weight = laws.gravity[1] * c - laws.gravity[0] * s
    local.force[row] = -spin * spin * c - spin_rate * s
    local.force[row + 1] = -spin * spin * s + spin_rate * c
    local.force[row + 2] = -(acceleration[row] * s - acceleration[row + 1] * c + weight) / lever
    local.viscous[row, 2], local.viscous[row + 1, 2] = -2.0 * spin * c / lever, -2.0 * spin * s / lever
    local.inertial[row, 2], local.inertial[row + 1, 2] = -s / lever, c / lever
    local.inertial[row + 2, 0], local.inertial[row + 2, 1] = -s / lever, c / lever


@routine
def unbalance_energy(laws: UnbalanceLaws, entry: int, local: LocalState, row: int) -> float:
    """Return T + V, J: T is linear in the motion across the axis."""
    amount = 0.0 if laws.steady[0] else laws.amount[entry]
    angle = laws.angle[entry] + 2.0 * math.pi * local.position[laws.phase[entry]]
    c, s = amount * math.cos(angle), amount * math.sin(angle)
    spin = (local.rate[row + 2] + local.drift[row + 2]) / laws.lever[entry]
    kinetic = spin * (c * local.rate[row + 1] - s * local.rate[row])
    return float(kinetic - laws.gravity[0] * c - laws.gravity[1] * s)
