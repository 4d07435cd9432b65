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
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dynamics.bearings import BallBearing
from dynamics.bearings.rolling_bearing import AGAINST, ALONG, BOTH, LOCATED
from dynamics.kernels.compiled import compiled, inner
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.types import FloatArray, IntArray

HOLDS = ALONG | AGAINST
STEPS = 100  # most safeguarded Newton steps to the place of a ring that slides
SETTLED = 1e-12  # thrust over the sum of the loads of all balls, at which a sliding ring rests
Seat = tuple[float, float, float, float, float, float, float, float]
Thrust = tuple[float, float, float, float, float, float, float]
DIRECTIONS, AXIAL = 5, 2  # number of displacements of a bearing (x, y, z, tilt_x, tilt_y), and index of z


@dataclass(frozen=True)
class RowPlacement:
    """Data of a row of elements beside its geometry: coordinates, damping and seats."""

    copies: int = 1
    """Number of parts of each element, evenly spaced, that share its stiffness: more than 1 averages the
    passing.
    """
    lever: float = 1.0
    """Length that makes coordinates of tilts, m; 1: coordinates are in rad and moments in N m."""
    shift: float = 0.0
    """Displacement of the inner ring along z, less that of the outer, at which the coordinates are 0, m."""
    damping: float = 0.0
    """Damping of an element over its load, s/m."""
    locating: str = BOTH
    """Directions in which the rings are held in their seats, see `dynamics.bearings.rolling_bearing`."""


class BallElements(NamedTuple):
    """Balls of l bearings."""

    balls: IntArray
    """Number of balls of each bearing. Shape (l,)."""
    stiffness: FloatArray
    """c of a ball between both grooves, N/m^1.5. Shape (l,)."""
    damping: FloatArray
    """Damping of a ball over its load, s/m. Shape (l,)."""
    reach: FloatArray
    """A: distance of the centers of curvature of both grooves where the ball just touches, m. Shape (l,)."""
    radial: FloatArray
    axial: FloatArray
    """`radial`, `axial`: Center of the inner groove seen from that of the outer at no displacement, m. Shape
    (l,) each.
    """
    arm_radius: FloatArray
    arm_axial: FloatArray
    """`arm_radius`, `arm_axial`: Center of the inner groove seen from the bearing's center, over the lever of
    tilts. Shape (l,) each.
    """
    located: IntArray
    """Directions in which the rings are held in their seats, `rolling_bearing.LOCATED`. Shape (l,)."""

    @classmethod
    def packed(cls, rows: Sequence[tuple[BallBearing, RowPlacement]]) -> BallElements:
        """Lay out `rows` with their placements."""
        figures = [_figures(bearing, placement) for bearing, placement in rows]
        return cls(
            balls=np.array([bearing.count * placement.copies for bearing, placement in rows], dtype=np.int64),
            located=np.array([LOCATED[placement.locating] for _, placement in rows], dtype=np.int64),
            **{
                name: np.array([values[name] for values in figures], dtype=float)
                for name in cls._fields
                if name not in ("balls", "located")
            },
        )


def _figures(bearing: BallBearing, placement: RowPlacement) -> dict[str, float]:
    """Return the figures of a row by the fields of `BallElements`; clearance leaves it in its middle."""
    angle, reach = bearing.free_contact_angle, bearing.groove_distance
    offset = (bearing.inner_groove - 0.5) * bearing.diameter
    radial, axial, height = reach - bearing.clearance / 2.0, 0.0, 0.0
    if bearing.contact_angle != 0.0:
        toward = math.copysign(1.0, angle)
        radial, axial = reach * math.cos(angle), reach * math.sin(angle) - toward * bearing.clearance
        height = offset * math.sin(angle)
    arm = bearing.pitch_diameter / 2.0 + offset * math.cos(angle)
    return {
        "stiffness": bearing.element_stiffness / placement.copies,
        "damping": placement.damping,
        "reach": reach,
        "radial": radial,
        "axial": axial + placement.shift,
        "arm_radius": arm / placement.lever,
        "arm_axial": height / placement.lever,
    }


@inner
def _grooves(
    laws: BallElements, entry: int, c: float, s: float, y: FloatArray, row: int, z: float
) -> tuple[float, float, float]:
    """Return radial and axial part of v of the ball at the cosine and sine `c`, `s`, and its length.

    `z` is the axial displacement of the rings against each other.
    """
    turn = y[row + 4] * c - y[row + 3] * s
    v_r = laws.radial[entry] + y[row] * c + y[row + 1] * s + laws.arm_axial[entry] * turn
    v_z = laws.axial[entry] + z - laws.arm_radius[entry] * turn
    return v_r, v_z, math.sqrt(v_r * v_r + v_z * v_z)


@inner
def cage_angle(local: LocalState, turned: int) -> float:
    """Return the angle of the position `turned`, which is in revolutions, rad; 0 if it is -1: averaged."""
    return 2.0 * math.pi * float(local.position[turned]) if turned >= 0 else 0.0


@routine
def axial_seat(laws: BallElements, entry: int, local: LocalState, row: int, turned: int) -> Seat:
    """Return the position of a ring along the axis, and the thrust that presses it against its seat.

    A ring that slides stands between the places where the grooves of all balls are on one side. Between them
    the thrust of the balls grows with z, and safeguarded Newton steps find its zero.

    Returns
    -------
    tuple of float
        1.0 where the seat holds the ring, 0.0 where it slides; z of the rings against each other (m); the
        thrust on the seat (N), 0 of a ring that slides; the derivatives of the thrust in the five
        displacements at this z.
    """
    y, angle, hold = local.coordinate, cage_angle(local, turned), laws.located[entry]
    if hold != 0:
        thrust, kx, ky, kz, ktx, kty, _ = _thrust(laws, entry, angle, y, row, y[row + 2])
        if (thrust >= 0.0 and hold & ALONG) or (thrust <= 0.0 and hold & AGAINST):
            return 1.0, y[row + 2], thrust, kx, ky, kz, ktx, kty
    reach = laws.arm_radius[entry] * math.sqrt(y[row + 3] * y[row + 3] + y[row + 4] * y[row + 4])
    z = -laws.axial[entry]
    low, high = z - reach, z + reach
    thrust, kx, ky, kz, ktx, kty, load = _thrust(laws, entry, angle, y, row, z)
    for _ in range(STEPS):
        if abs(thrust) <= SETTLED * load:
            break
        if thrust > 0.0:
            high = z
        else:
            low = z
        z -= thrust / kz
        if not low < z < high:
            z = 0.5 * (low + high)
        thrust, kx, ky, kz, ktx, kty, load = _thrust(laws, entry, angle, y, row, z)
    return 0.0, z, 0.0, kx, ky, kz, ktx, kty


@inner
def _thrust(laws: BallElements, entry: int, angle: float, y: FloatArray, row: int, z: float) -> Thrust:
    """Return the axial force of all balls, its derivatives (`kx` to `kty`) and the sum of their loads."""
    thrust, kx, ky, kz, ktx, kty, total = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    radius, height = laws.arm_radius[entry], laws.arm_axial[entry]
    step = 2.0 * math.pi / laws.balls[entry]
    c, s, turn_c, turn_s = math.cos(angle), math.sin(angle), math.cos(step), math.sin(step)
    for ball in range(laws.balls[entry]):
        if ball > 0:  # turned from the one before: sines would cost more than the rest
            c, s = c * turn_c - s * turn_s, s * turn_c + c * turn_s
        v_r, v_z, length = _grooves(laws, entry, c, s, y, row, z)
        press = length - laws.reach[entry]
        if press <= 0.0:
            continue
        rigid = laws.stiffness[entry] * math.sqrt(press)
        load, e_r, e_z = rigid * press, v_r / length, v_z / length
        along, across = 1.5 * rigid * e_z, load / length * e_r
        radial, tilting = along * e_r - across * e_z, along * (height * e_r - radius * e_z)
        tilting -= across * (height * e_z + radius * e_r)
        thrust += load * e_z
        total += load
        kx += radial * c
        ky += radial * s
        kz += along * e_z + across * e_r
        ktx -= tilting * s
        kty += tilting * c
    return thrust, kx, ky, kz, ktx, kty, total


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
    y, angle, loose = local.coordinate, cage_angle(local, turned), laws.located[entry] != HOLDS
    z, axial_rate = y[row + AXIAL], 0.0 if loose else local.rate[row + AXIAL]
    hold, thrust, kx, ky, kz, ktx, kty = 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if loose:
        hold, z, thrust, kx, ky, kz, ktx, kty = axial_seat(laws, entry, local, row, turned)
    radius, height = laws.arm_radius[entry], laws.arm_axial[entry]
    step = 2.0 * math.pi / laws.balls[entry]
    for ball in range(laws.balls[entry]):
        c, s = math.cos(angle + ball * step), math.sin(angle + ball * step)
        v_r, v_z, length = _grooves(laws, entry, c, s, y, row, z)
        press = length - laws.reach[entry]
        if press <= 0.0:
            continue
        rigid = laws.stiffness[entry] * math.sqrt(press)
        e_r, e_z = v_r / length, v_z / length
        along, across = height * e_r - radius * e_z, -height * e_z - radius * e_r
        g = (e_r * c, e_r * s, e_z, -s * along, c * along)
        h = (-e_z * c, -e_z * s, e_r, -s * across, c * across)
        _add(local, row, g, h, rigid, press, laws.damping[entry], length, axial_rate)
    if loose and hold > 0.0:
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
    """Add the forces of a ball with the elastic force `rigid` `press`, along g and across it."""
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
    return _energy(laws, entry, local, row, turned, _axial_displacement(laws, entry, local, row, turned))


@inner
def _axial_displacement(laws: BallElements, entry: int, local: LocalState, row: int, turned: int) -> float:
    if laws.located[entry] == HOLDS:
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
        v_r, v_z, length = _grooves(laws, entry, c, s, y, row, z)
        press = length - laws.reach[entry]
        if press <= 0.0:
            continue
        load = laws.stiffness[entry] * math.sqrt(press) * press
        turning = y[row + 4] * s + y[row + 3] * c
        across = y[row + 1] * c - y[row] * s - laws.arm_axial[entry] * turning
        energy += 0.4 * load * press
        slope += load * (v_r * across + v_z * laws.arm_radius[entry] * turning) / length
    return energy, 2.0 * math.pi * slope


@compiled
def ball_reaction(laws: BallElements, local: LocalState, load: FloatArray) -> tuple[float, float]:
    """Write all of the first bearing, whose rows and position are the first, and return its energy and slope.

    `load` (Z, 1): the elastic load of every ball, N.
    """
    balls(laws, 0, local, 0, 0)
    y, angle, step = local.coordinate, cage_angle(local, 0), 2.0 * math.pi / laws.balls[0]
    z = _axial_displacement(laws, 0, local, 0, 0)
    for ball in range(laws.balls[0]):
        c, s = math.cos(angle + ball * step), math.sin(angle + ball * step)
        press = max(_grooves(laws, 0, c, s, y, 0, z)[2] - laws.reach[0], 0.0)
        load[ball, 0] = laws.stiffness[0] * math.sqrt(press) * press
    return _energy(laws, 0, local, 0, 0, z)
