"""The grooves between which the balls of bearings lie, laid out for compiled functions.

A ball without mass lies on the line v through the centers of curvature of both grooves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dynamics.bearings import BallBearing
from dynamics.bearings.roller_bearing import BOTH, HELD
from dynamics.kernels.compiled import inner
from dynamics.types import FloatArray, IntArray

# How a row of rolling elements is laid out for compiled functions.


@dataclass(frozen=True)
class RowPlacement:
    """What a row's geometry does not say.

    Attributes
    ----------
    copies : int
        Each element as so many that share its stiffness, evenly spaced: more than 1 averages its passing.
    lever : float
        Length that makes coordinates of tilts, m; 1: coordinates are in rad and moments in N m.
    shift : float
        Displacement of the inner ring along z, less that of the outer, at which the coordinates are 0, m.
    damping : float
        Damping of an element over its load, s/m.
    locating : str
        Directions in which the rings are held in their seats, see `dynamics.bearings.roller_bearing`.
    """

    copies: int = 1
    lever: float = 1.0
    shift: float = 0.0
    damping: float = 0.0
    locating: str = BOTH


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
    held : (l,) int array
        Directions in which the rings are held in their seats, `locating.HELD`.
    """

    balls: IntArray
    stiffness: FloatArray
    damping: FloatArray
    reach: FloatArray
    radial: FloatArray
    axial: FloatArray
    arm_radius: FloatArray
    arm_axial: FloatArray
    held: IntArray


def pack_balls(rows: Sequence[tuple[BallBearing, RowPlacement]]) -> BallElements:
    """Lay out `rows` and how they are placed."""
    values = np.array([_values(bearing, place) for bearing, place in rows], dtype=float).reshape(-1, 7)
    balls = np.array([bearing.count * place.copies for bearing, place in rows], dtype=np.int64)
    held = np.array([HELD[place.locating] for _, place in rows], dtype=np.int64)
    stiffness, damping, reach, radial, axial, *arms = (np.ascontiguousarray(column) for column in values.T)
    return BallElements(balls, stiffness, damping, reach, radial, axial, arms[0], arms[1], held)


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
def grooves(
    laws: BallElements, entry: int, c: float, s: float, y: FloatArray, row: int, z: float
) -> tuple[float, float, float]:
    """Return radial and axial part of v of the ball at the cosine and sine `c`, `s`, and its length.

    `z` is the axial displacement of the rings against each other.
    """
    turn = y[row + 4] * c - y[row + 3] * s
    v_r = laws.radial[entry] + y[row] * c + y[row + 1] * s + laws.arm_axial[entry] * turn
    v_z = laws.axial[entry] + z - laws.arm_radius[entry] * turn
    return v_r, v_z, math.sqrt(v_r * v_r + v_z * v_z)
