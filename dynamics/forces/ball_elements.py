"""Balls between the grooves of two rings: force, tangent and energy from five displacements, compiled.

A ball without mass lies on the line through the centers of curvature of both grooves. That line is v long and
longer than A by the approach of the grooves, which the ball carries with c (|v| - A)^1.5.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from dynamics.forces.bearing_seat import DIRECTIONS, BearingSeat
from dynamics.forces.compiled import compiled, inner
from dynamics.types import FloatArray, IntArray


class BallElements(NamedTuple):
    """Balls of l bearings.

    Attributes
    ----------
    balls : (l,) int array
        Their number.
    stiffness : (l,) array
        c of a ball between both grooves, N/m^1.5.
    reach : (l,) array
        A: distance of the centers of curvature of both grooves where the ball just touches, m.
    radial, axial : (l,) arrays
        Center of the inner groove seen from that of the outer at no displacement, m.
    arm_radius, arm_axial : (l,) arrays
        Center of the inner groove seen from the bearing's center, m.
    """

    balls: IntArray
    stiffness: FloatArray
    reach: FloatArray
    radial: FloatArray
    axial: FloatArray
    arm_radius: FloatArray
    arm_axial: FloatArray


@compiled
def ball_elements(laws: BallElements, entry: int, angle: float, seat: BearingSeat) -> tuple[float, float]:
    """Write force, tangent and loads of a bearing; return its energy (J) and the derivative in `angle`.

    The first ball stands at `angle` (rad) from x towards y, the others evenly behind it. With r, z along the
    radius of a ball and the axis, e = v/|v| and rows b_r, b_z of the motion of the inner groove's center,

        force = sum Q g,    tangent = sum dQ/d|v| g g^T + Q/|v| h h^T,    g = e_r b_r + e_z b_z,
        h = e_r b_z - e_z b_r.
    """
    _clear(seat)
    x, y, z = seat.displacement[0], seat.displacement[1], seat.displacement[2]
    tilt_x, tilt_y = seat.displacement[3], seat.displacement[4]
    radius, height, reach = laws.arm_radius[entry], laws.arm_axial[entry], laws.reach[entry]
    step = 2.0 * math.pi / laws.balls[entry]
    energy, slope = 0.0, 0.0
    for ball in range(laws.balls[entry]):
        c, s = math.cos(angle + ball * step), math.sin(angle + ball * step)
        turn = tilt_y * c - tilt_x * s
        v_r = laws.radial[entry] + x * c + y * s + height * turn
        v_z = laws.axial[entry] + z - radius * turn
        length = math.sqrt(v_r * v_r + v_z * v_z)
        press = length - reach
        if press <= 0.0:
            continue
        rigid = laws.stiffness[entry] * math.sqrt(press)
        load, e_r, e_z = rigid * press, v_r / length, v_z / length
        along, across = height * e_r - radius * e_z, -height * e_z - radius * e_r
        g = (e_r * c, e_r * s, e_z, -s * along, c * along)
        h = (-e_z * c, -e_z * s, e_r, -s * across, c * across)
        _add(seat, g, h, load, 1.5 * rigid, load / length)
        seat.load[ball, 0] = load
        energy += 0.4 * load * press
        slope += load * (e_r * (y * c - x * s) - along * (tilt_y * s + tilt_x * c))
    return energy, slope


@inner
def _clear(seat: BearingSeat) -> None:
    """Set the answer to zero."""
    for i in range(DIRECTIONS):
        seat.force[i] = 0.0
        for j in range(DIRECTIONS):
            seat.tangent[i, j] = 0.0
    seat.load[:] = 0.0


@inner
def _add(
    seat: BearingSeat,
    g: tuple[float, ...],
    h: tuple[float, ...],
    load: float,
    stiffness: float,
    across: float,
) -> None:
    """Add a ball's force `load` along g, its `stiffness` there and that `across`."""
    for i in range(DIRECTIONS):
        seat.force[i] += load * g[i]
        for j in range(DIRECTIONS):
            seat.tangent[i, j] += stiffness * g[i] * g[j] + across * h[i] * h[j]
