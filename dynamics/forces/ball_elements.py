"""Balls between the grooves of two rings: forces, derivatives and energy from five displacements, compiled.

A ball without mass lies on the line through the centers of curvature of both grooves. That line is v long and
longer than A by the approach of the grooves, which the ball carries with Q = c (|v| - A)^1.5.

References
----------
.. [1] K. H. Hunt, F. R. E. Crossley, Coefficient of restitution interpreted as damping in vibroimpact, ASME
   Journal of Applied Mechanics 42 (1975) 440-445: damping in proportion to the elastic force.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dynamics.bearing_rows import BallBearing
from dynamics.forces.cage_angle import cage_angle
from dynamics.forces.compiled import compiled, inner
from dynamics.forces.local_state import LocalState
from dynamics.forces.routine import routine
from dynamics.forces.row_placement import RowPlacement
from dynamics.types import FloatArray, IntArray

DIRECTIONS = 5


class BallElements(NamedTuple):
    """Balls of l bearings.

    Attributes
    ----------
    balls : (l,) int array
        Their number.
    stiffness : (l,) array
        c of a ball between both grooves, N/m^1.5.
    damping : (l,) array
        Damping of a ball over its load, s/m.
    reach : (l,) array
        A: distance of the centers of curvature of both grooves where the ball just touches, m.
    radial, axial : (l,) arrays
        Center of the inner groove seen from that of the outer at no displacement, m.
    arm_radius, arm_axial : (l,) arrays
        Center of the inner groove seen from the bearing's center, over the lever of tilts.
    """

    balls: IntArray
    stiffness: FloatArray
    damping: FloatArray
    reach: FloatArray
    radial: FloatArray
    axial: FloatArray
    arm_radius: FloatArray
    arm_axial: FloatArray


def pack_balls(rows: Sequence[tuple[BallBearing, RowPlacement]]) -> BallElements:
    """Lay out `rows` and how they are placed."""
    values = np.array([_values(bearing, place) for bearing, place in rows], dtype=float).reshape(-1, 7)
    balls = np.array([bearing.count * place.copies for bearing, place in rows], dtype=np.int64)
    return BallElements(balls, *(np.ascontiguousarray(column) for column in values.T))


def _values(bearing: BallBearing, place: RowPlacement) -> tuple[float, ...]:
    """Return the figures of a row in the order of `BallElements`; clearance leaves it in its middle."""
    angle, reach = bearing.free_contact_angle, bearing.groove_distance
    offset = (bearing.inner_groove - 0.5) * bearing.diameter
    radial, axial, height = reach - bearing.clearance / 2.0, 0.0, 0.0
    if bearing.contact_angle != 0.0:
        toward = math.copysign(1.0, angle)
        radial, axial = reach * math.cos(angle), reach * math.sin(angle) - toward * bearing.clearance
        height = offset * math.sin(angle)
    arm = bearing.pitch_diameter / 2.0 + offset * math.cos(angle)
    stiffness = bearing.element_stiffness / place.copies
    arms = arm / place.lever, height / place.lever
    return stiffness, place.damping, reach, radial, axial + place.shift, *arms


@inner
def _grooves(
    laws: BallElements, entry: int, c: float, s: float, y: FloatArray, row: int
) -> tuple[float, float, float]:
    """Return radial and axial part of v of the ball at the cosine and sine `c`, `s`, and its length."""
    turn = y[row + 4] * c - y[row + 3] * s
    v_r = laws.radial[entry] + y[row] * c + y[row + 1] * s + laws.arm_axial[entry] * turn
    v_z = laws.axial[entry] + y[row + 2] - laws.arm_radius[entry] * turn
    return v_r, v_z, math.sqrt(v_r * v_r + v_z * v_z)


@routine
def balls(laws: BallElements, entry: int, local: LocalState, row: int, turned: int) -> None:
    """Write forces and derivatives of a bearing into its five rows, the first of which is `row`.

    With r, z along the radius of a ball and the axis, e = v/|v|, rows b_r, b_z of the motion of the inner
    groove's center, press p = |v| - A, p' = g y' and Q d p' the damping of a ball,

        f = sum F g,    F = Q (1 + d p') or 0 if that is tensile,    g = e_r b_r + e_z b_z,
        df/dy = sum dF/dp g g^T + F/|v| h h^T + Q d (h y')/|v| g h^T,    h = e_r b_z - e_z b_r,
        df/dy' = sum Q d g g^T.

    The first ball stands at the cage's angle from x towards y, position `turned`, the others behind it.
    """
    for i in range(DIRECTIONS):
        local.force[row + i], local.elastic[row + i] = 0.0, 0.0
        for j in range(DIRECTIONS):
            local.tangent[row + i, j], local.viscous[row + i, j] = 0.0, 0.0
    y, angle = local.coordinate, cage_angle(local, turned)
    radius, height = laws.arm_radius[entry], laws.arm_axial[entry]
    step = 2.0 * math.pi / laws.balls[entry]
    for ball in range(laws.balls[entry]):
        c, s = math.cos(angle + ball * step), math.sin(angle + ball * step)
        v_r, v_z, length = _grooves(laws, entry, c, s, y, row)
        press = length - laws.reach[entry]
        if press <= 0.0:
            continue
        rigid = laws.stiffness[entry] * math.sqrt(press)
        e_r, e_z = v_r / length, v_z / length
        along, across = height * e_r - radius * e_z, -height * e_z - radius * e_r
        g = (e_r * c, e_r * s, e_z, -s * along, c * along)
        h = (-e_z * c, -e_z * s, e_r, -s * across, c * across)
        _add(local, row, g, h, rigid, press, laws.damping[entry], length)


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
) -> None:
    """Add what a ball of the elastic force `rigid` `press` does along g and across it."""
    load, closing, sliding = rigid * press, 0.0, 0.0
    for i in range(DIRECTIONS):
        closing += g[i] * local.rate[row + i]
        sliding += h[i] * local.rate[row + i]
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


@routine
def balls_energy(
    laws: BallElements, entry: int, local: LocalState, row: int, turned: int
) -> tuple[float, float]:
    """Return the energy stored at the displacement in `row` and on, J, and its derivative, J/revolution."""
    y, angle = local.coordinate, cage_angle(local, turned)
    step = 2.0 * math.pi / laws.balls[entry]
    energy, slope = 0.0, 0.0
    for ball in range(laws.balls[entry]):
        c, s = math.cos(angle + ball * step), math.sin(angle + ball * step)
        v_r, v_z, length = _grooves(laws, entry, c, s, y, row)
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
    angle, step = cage_angle(local, 0), 2.0 * math.pi / laws.balls[0]
    for ball in range(laws.balls[0]):
        c, s = math.cos(angle + ball * step), math.sin(angle + ball * step)
        press = max(_grooves(laws, 0, c, s, local.coordinate, 0)[2] - laws.reach[0], 0.0)
        load[ball, 0] = laws.stiffness[0] * math.sqrt(press) * press
    energy, slope = balls_energy(laws, 0, local, 0, 0)
    return energy, slope
