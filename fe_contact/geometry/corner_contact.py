"""Corner contact: the tip edge of one gear on the other's flank, off the line of action.

Before the path of contact begins (approach) the wheel's tip edge can touch the pinion's flank, and after it
ends (exit) the pinion's tip edge can touch the wheel's. Rigid gears are apart there; the gap is exact.

Derivation. Hold the tip gear at the roll length l its flank would touch at on the line of action, l beyond
its tip roll length l_a. The normal at its tip edge touches the base circle at the angle
tau = alpha_wt + (l_a - l) / r_b from the line of centers, which places the edge. The edge's distance rho
from the other center gives the roll length sqrt(rho^2 - r_b^2) of the flank point it can touch, and its
polar angle there the rotation at which that gear touches it. The gap is what the conjugate rotation lacks
of it, times the base radius.

Signs. Angles of an external pair are seen from either gear towards the other, half a turn apart. A ring gear
and its pinion are seen the same way, both from the ring's center towards the mesh. With the gears' signs
(`Toothing.sign`; their product is the pair's) one set of formulas serves both kinds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bounds import at_least
from fe_contact.errors import InputError
from fe_contact.geometry.parallel_axes import ParallelAxes
from fe_contact.geometry.toothing import Toothing
from fe_contact.types import BoolArray, FloatArray

Side = Literal["approach", "exit"]
_ITERATIONS = 50
_ROUNDING = 4.0 * float(np.finfo(float).eps)
"""Rounding error of a gap over the center distance. A gap is a difference of lengths of that order."""


@dataclass(frozen=True)
class CornerContact:
    """State of a tooth pair whose tip edge faces the mating flank; NaN where not `valid`."""

    gap: FloatArray
    """Rigid gap in m on the line of action, >= 0: r_b2 times the lag of the driven gear that closes it, the
    driving gear's angle held.
    """
    flank_roll_length: FloatArray
    """Roll length at which the edge touches the mating flank, m: of gear 1 at approach, of gear 2 at exit.
    The edge itself stays at the tip roll length of its gear.
    """
    slope_angle: FloatArray
    """Angle phi in rad, >= 0, between the two flanks at the edge: they open by phi per length away from it.
    """
    lever_arm_ratio_pinion: FloatArray
    lever_arm_ratio_wheel: FloatArray
    """`lever_arm_ratio_pinion`, `lever_arm_ratio_wheel`: Moment arm of the corner force about the gear's axis
    over its base radius. The force acts along the mating flank's normal, so the ratio is 1 for the gear whose
    flank is touched. For the wheel it is also the rate at which a lag on the line of action closes the
    distance along that normal.
    """
    valid: BoolArray
    """False where the edge meets no involute (below the form point, or past the tooth's tip), and where the
    force would pass its gear's axis on the other side and no longer drive.
    """


class _Touch(NamedTuple):
    """The flank gear turned until it touches the tip edge, the tip gear held."""

    gap: FloatArray
    flank_roll_length: FloatArray
    slope_angle: FloatArray
    lever_arm_ratio: FloatArray  # of the tip gear


def corner_contact(pair: ParallelAxes, side: Side, overshoot: ArrayLike) -> CornerContact:
    """Exact rigid corner contact of one tooth pair.

    Raises `InputError`: an unknown side, or a negative overshoot.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        The gears; their modifications are not included.
    side : {"approach", "exit"}
        Whether the pair has not reached the path of contact yet (edge of gear 2 on flank 1), or has left it
        (edge of gear 1 on flank 2).
    overshoot : array_like
        Distance in m, >= 0, of the nominal roll length l_1 given by the driving gear's angle
        (`GearPair.roll_lengths`) from the path's end: l_A - l_1 at approach, l_1 - l_E at exit.

    Returns
    -------
    CornerContact
        Arrays of the shape of `overshoot`.
    """
    beyond = np.asarray(overshoot, dtype=float)
    if not np.all(beyond >= 0.0):
        raise InputError("overshoot", overshoot, at_least(0.0), "Inside the path of contact there is no gap.")
    unity = np.ones_like(beyond)
    if side == "exit":
        edge = pair.pinion.tip_roll_length
        touch = _touch(pair, pair.pinion, pair.wheel, edge, edge + beyond)
        return _masked_contact(touch, pair.wheel, touch.lever_arm_ratio, unity)
    if side == "approach":
        edge = pair.wheel.tip_roll_length
        touch = _touch_by_tip_gear(pair, pair.wheel, pair.pinion, edge, edge + pair.wheel.sign * beyond)
        return _masked_contact(touch, pair.pinion, unity, touch.lever_arm_ratio)
    raise InputError("side", side, 'one of "approach" and "exit"')


def edge_gap(pair: ParallelAxes, side: Side, edge: ArrayLike, roll_length: ArrayLike) -> FloatArray:
    """Exact rigid gap in m of points of one flank on the other, as if the flank ended in an edge there.

    Parameters
    ----------
    side : {"approach", "exit"}
        Whether the points belong to gear 2, or to gear 1.
    edge, roll_length : array_like
        Roll lengths in m of the points, and nominal ones of their gear: further towards its tip.

    Returns
    -------
    array
        NaN where such an edge meets no involute or cannot drive.
    """
    points, nominal = np.broadcast_arrays(np.asarray(edge, float), np.asarray(roll_length, float))
    if side == "exit":
        touch = _touch(pair, pair.pinion, pair.wheel, points, nominal)
    else:
        touch = _touch_by_tip_gear(pair, pair.wheel, pair.pinion, points, nominal)
    return np.where(touch.lever_arm_ratio > 0.0, touch.gap, np.nan)


def _touch(
    pair: ParallelAxes, tip: Toothing, flank: Toothing, edge: FloatArray | float, roll_length: FloatArray
) -> _Touch:
    working, sign = pair.working_pressure_angle, tip.sign * flank.sign
    distance = tip.sign * pair.center_distance  # of the tip gear's center along the flank gear's +x
    tip_foot = working + (edge - roll_length) / tip.base_radius
    sine, cosine = np.sin(tip_foot), np.cos(tip_foot)
    # the edge as seen from the flank gear's center
    x = distance - sign * tip.base_radius * cosine - sign * edge * sine
    y = sign * (edge * cosine - tip.base_radius * sine)
    with np.errstate(invalid="ignore"):
        touched = np.sqrt(x**2 + y**2 - flank.base_radius**2)
    flank_foot = np.arctan2(y, x) + np.arctan2(touched, flank.base_radius)
    rolled = touched - flank.base_radius * (flank_foot - working)
    gap = flank.sign * (rolled - tip.sign * pair.common_tangent + sign * roll_length)
    arm = sign * (distance * np.cos(flank_foot) - flank.base_radius) / tip.base_radius
    return _Touch(gap, touched, flank_foot - tip_foot, arm)


def _touch_by_tip_gear(
    pair: ParallelAxes, tip: Toothing, flank: Toothing, edge: FloatArray | float, roll_length: FloatArray
) -> _Touch:
    """Turn the tip gear until its edge touches the flank gear, held where conjugate to `roll_length`.

    A lag e brings the tip gear to roll_length + e (a ring gear to roll_length - e), and it touches if the
    flank gear, turned instead, would need just that: e = gap(roll_length + e). The gap is convex, so Newton's
    iteration from e = 0 ascends to the root. What has reached it stays, whatever is solved beside it.
    """
    lag = np.zeros_like(roll_length)
    for _ in range(_ITERATIONS):
        touch = _touch(pair, tip, flank, edge, roll_length + tip.sign * lag)
        reachable = touch.lever_arm_ratio > 0.0
        step = np.where(reachable, touch.gap - lag, np.nan) / np.where(reachable, touch.lever_arm_ratio, 1.0)
        settled = np.abs(step) <= _ROUNDING * pair.center_distance
        lag = np.where(settled, lag, lag + step)
        if np.all(settled | np.isnan(step)):
            break
    return touch._replace(gap=lag)


def _masked_contact(
    touch: _Touch, flank: Toothing, pinion_arm: FloatArray, wheel_arm: FloatArray
) -> CornerContact:
    """Blank points that lie off the flank's involute or cannot drive."""
    slack = 1e-9 * flank.normal_module
    roll = touch.flank_roll_length
    valid = flank.sign * (roll - flank.form_roll_length) >= -slack
    valid &= flank.sign * (roll - flank.tip_roll_length) <= slack
    valid &= np.isfinite(touch.gap) & (touch.lever_arm_ratio > 0.0)
    parts = (np.maximum(touch.gap, 0.0), roll, np.maximum(touch.slope_angle, 0.0), pinion_arm, wheel_arm)
    gap, flank_roll_length, slope, arm_1, arm_2 = (np.where(valid, part, np.nan) for part in parts)
    return CornerContact(gap, flank_roll_length, slope, arm_1, arm_2, valid)
