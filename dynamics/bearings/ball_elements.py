"""Balls between the grooves of two rings: forces, derivatives and energy from five displacements, compiled.

A ball without mass lies on the line through the centers of curvature of both grooves. That line is v long and
longer than A by the approach of the grooves, which the ball carries with Q = c (|v| - A)^1.5. A ring that its
seat does not hold along the axis slides to where it carries no axial force, see `axial_seat`.

References
----------
.. [1] K. H. Hunt, F. R. E. Crossley, Coefficient of restitution interpreted as damping in vibroimpact, ASME
   Journal of Applied Mechanics 42 (1975) 440-445: damping in proportion to the elastic force.
"""

from __future__ import annotations

import math

from dynamics.bearings.axial_seat import HOLDS, axial_seat, cage_angle
from dynamics.bearings.ball_grooves import BallElements, grooves
from dynamics.kernels.compiled import compiled, inner
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.types import FloatArray

DIRECTIONS, AXIAL = 5, 2


@routine
def balls(laws: BallElements, entry: int, local: LocalState, row: int, turned: int) -> None:
    """Write forces and derivatives of a bearing into its five rows, the first of which is `row`.

    With r, z along the radius of a ball and the axis, e = v/|v|, rows b_r, b_z of the motion of the inner
    groove's center, press p = |v| - A, p' = g y' and Q d p' the damping of a ball,

        f = sum F g,    F = Q (1 + d p') or 0 if that is tensile,    g = e_r b_r + e_z b_z,
        df/dy = sum dF/dp g g^T + F/|v| h h^T + Q d (h y')/|v| g h^T,    h = e_r b_z - e_z b_r,
        df/dy' = sum Q d g g^T.

    Where a ring may slide in its seat, balls are damped by the other four rates alone. The first ball stands
    at the cage's angle from x towards y, position `turned`, the others behind it.
    """
    for i in range(DIRECTIONS):
        local.force[row + i], local.elastic[row + i] = 0.0, 0.0
        for j in range(DIRECTIONS):
            local.tangent[row + i, j], local.viscous[row + i, j] = 0.0, 0.0
    y, angle, loose = local.coordinate, cage_angle(local, turned), laws.held[entry] != HOLDS
    z, axial_rate = y[row + AXIAL], 0.0 if loose else local.rate[row + AXIAL]
    held, thrust, kx, ky, kz, ktx, kty = 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if loose:
        held, z, thrust, kx, ky, kz, ktx, kty = axial_seat(laws, entry, local, row, turned)
    radius, height = laws.arm_radius[entry], laws.arm_axial[entry]
    step = 2.0 * math.pi / laws.balls[entry]
    for ball in range(laws.balls[entry]):
        c, s = math.cos(angle + ball * step), math.sin(angle + ball * step)
        v_r, v_z, length = grooves(laws, entry, c, s, y, row, z)
        press = length - laws.reach[entry]
        if press <= 0.0:
            continue
        rigid = laws.stiffness[entry] * math.sqrt(press)
        e_r, e_z = v_r / length, v_z / length
        along, across = height * e_r - radius * e_z, -height * e_z - radius * e_r
        g = (e_r * c, e_r * s, e_z, -s * along, c * along)
        h = (-e_z * c, -e_z * s, e_r, -s * across, c * across)
        _add(local, row, g, h, rigid, press, laws.damping[entry], length, axial_rate)
    if loose and held > 0.0:
        _press_seat(local, row, thrust, (kx, ky, kz, ktx, kty), laws.damping[entry])
    elif loose:
        _condense(local, row, (kx, ky, kz, ktx, kty))


@inner
def _add(
    local: LocalState,
    row: int,
    g: tuple[float, ...],
    h: tuple[float, ...],
    rigid: float,
    press: float,
    damping: float,
    length: float,
    axial_rate: float,
) -> None:
    """Add what a ball of the elastic force `rigid` `press` does along g and across it."""
    load, closing, sliding = rigid * press, 0.0, 0.0
    for i in range(DIRECTIONS):
        rate = axial_rate if i == AXIAL else local.rate[row + i]
        closing += g[i] * rate
        sliding += h[i] * rate
        local.elastic[row + i] += load * g[i]
    factor = 1.0 + damping * closing
    if factor <= 0.0:
        return
    stiffness, across = 1.5 * rigid * factor, load * factor / length
    viscous, mixed = load * damping, load * damping * sliding / length
    for i in range(DIRECTIONS):
        local.force[row + i] += load * factor * g[i]
        for j in range(DIRECTIONS):
            local.tangent[row + i, j] += stiffness * g[i] * g[j] + (across * h[i] + mixed * g[i]) * h[j]
            local.viscous[row + i, j] += viscous * g[i] * g[j]


@inner
def _press_seat(local: LocalState, row: int, thrust: float, slope: tuple[float, ...], damping: float) -> None:
    """Write the axial row of a ring that presses its seat with `thrust`, of derivatives `slope`.

    The seat is damped in proportion to its thrust and never pulls, as the balls are.
    """
    axial = row + AXIAL
    factor = max(0.0, 1.0 + damping * math.copysign(1.0, thrust) * local.rate[axial])
    for i in range(DIRECTIONS):
        local.tangent[axial, i] = factor * slope[i]
        local.viscous[axial, i], local.viscous[row + i, AXIAL] = 0.0, 0.0
    local.force[axial], local.elastic[axial] = thrust * factor, thrust
    if factor > 0.0:
        local.viscous[axial, AXIAL] = abs(thrust) * damping


@inner
def _condense(local: LocalState, row: int, slope: tuple[float, ...]) -> None:
    """Let a ring slide so that the thrust, of derivatives `slope`, stays 0: static condensation of z."""
    axial = row + AXIAL
    for i in range(DIRECTIONS):
        follows = -local.tangent[row + i, AXIAL] / slope[AXIAL] if slope[AXIAL] > 0.0 else 0.0
        for j in range(DIRECTIONS):
            local.tangent[row + i, j] += follows * slope[j]
        local.tangent[row + i, AXIAL], local.viscous[row + i, AXIAL] = 0.0, 0.0
    for j in range(DIRECTIONS):
        local.tangent[axial, j], local.viscous[axial, j] = 0.0, 0.0
    local.force[axial], local.elastic[axial] = 0.0, 0.0


@routine
def balls_energy(
    laws: BallElements, entry: int, local: LocalState, row: int, turned: int
) -> tuple[float, float]:
    """Return the energy stored at the displacement in `row` and on, J, and its derivative, J/revolution."""
    return _energy(laws, entry, local, row, turned, _axial(laws, entry, local, row, turned))


@inner
def _axial(laws: BallElements, entry: int, local: LocalState, row: int, turned: int) -> float:
    """Return the axial displacement of the rings against each other."""
    if laws.held[entry] == HOLDS:
        return float(local.coordinate[row + AXIAL])
    return float(axial_seat(laws, entry, local, row, turned)[1])


@inner
def _energy(
    laws: BallElements, entry: int, local: LocalState, row: int, turned: int, z: float
) -> tuple[float, float]:
    """Return energy and derivative at the axial displacement `z` of the rings."""
    y, angle = local.coordinate, cage_angle(local, turned)
    step, energy, slope = 2.0 * math.pi / laws.balls[entry], 0.0, 0.0
    for ball in range(laws.balls[entry]):
        c, s = math.cos(angle + ball * step), math.sin(angle + ball * step)
        v_r, v_z, length = grooves(laws, entry, c, s, y, row, z)
        press = length - laws.reach[entry]
        if press <= 0.0:
            continue
        load = laws.stiffness[entry] * math.sqrt(press) * press
        turning = y[row + 4] * s + y[row + 3] * c
        beside = y[row + 1] * c - y[row] * s - laws.arm_axial[entry] * turning
        energy += 0.4 * load * press
        slope += load * (v_r * beside + v_z * laws.arm_radius[entry] * turning) / length
    return energy, 2.0 * math.pi * slope


@compiled
def ball_reaction(laws: BallElements, local: LocalState, load: FloatArray) -> tuple[float, float]:
    """Write all of the first bearing, whose rows and position are the first, and return its energy and slope.

    `load` (Z, 1): the elastic load of every ball, N.
    """
    balls(laws, 0, local, 0, 0)
    y, angle, step = local.coordinate, cage_angle(local, 0), 2.0 * math.pi / laws.balls[0]
    z = _axial(laws, 0, local, 0, 0)
    for ball in range(laws.balls[0]):
        c, s = math.cos(angle + ball * step), math.sin(angle + ball * step)
        press = max(grooves(laws, 0, c, s, y, 0, z)[2] - laws.reach[0], 0.0)
        load[ball, 0] = laws.stiffness[0] * math.sqrt(press) * press
    return _energy(laws, 0, local, 0, 0, z)
