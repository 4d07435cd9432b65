"""The tip edge of a gear: sharp, rounded or chamfered (tip corner of ISO 21771-1).

The usable flank ends at the tip form circle d_Fa. Beyond it an arc of radius r goes on tangentially and runs
into the tip circle, or a straight chamfer. Both are counted in the transverse plane as material removed from
the involute, over the arc length of the flank from the tip form point: jump d + bend d^2/2.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from bounds import SiNote, Text, Words
from fe_contact.checks import within
from fe_contact.flank.involute import involute_normal, involute_point
from fe_contact.flank.tooth import Tooth

FLATTEST, STEEPEST = math.radians(5.0), math.radians(85.0)
"""Angles between flank and chamfer, rad; a flatter one is a relief."""
_HALVINGS = 50
_LOWEST = 1e-3  # of the normal module: a chamfer so low fits at any angle at which it reaches the tip circle
_ROUNDING = Text.of("It must leave an involute and some of the tip. ", SiNote("In m: 0.2 mm is 2e-4."))
_ANGLE = Text.of("The chamfer must run on towards the tip circle. ", SiNote("In rad, to the flank."))
_CHAMFER = "It must leave an involute and some of the tip; at a smaller angle it takes less of the tip."


def rounding_start(gear: Tooth, radius: float) -> float:
    """Roll length in m of the tip form point of a rounding that touches involute and tip circle.

    Its center lies on the normal of the tip form point, `radius` inside the tooth, and as far from the tip
    circle; NaN where there is none.
    """
    center = gear.tip_radius - gear.sign * radius
    if center < gear.base_radius:
        return math.nan
    return math.sqrt(center**2 - gear.base_radius**2) + gear.sign * radius


def chamfer_start(gear: Tooth, height: float) -> float:
    """Roll length in m of the tip form point of a chamfer that starts `height` from the tip circle."""
    radius = gear.tip_radius - gear.sign * height
    return math.nan if radius < gear.base_radius else gear.roll_length(radius)


def check_rounding(gear: Tooth, radius: float) -> None:
    """Raise `InputError` if a rounding does not fit between form circle and tip, or into half the tip."""

    def fits(trial: float) -> bool:
        roll = rounding_start(gear, trial)
        return _above_form_point(gear, roll) and _rounding_angle(gear, roll, trial) >= 0.0

    _check("modification.tip_rounding", radius, 0.0, fits, _ROUNDING)


def check_chamfer(gear: Tooth, height: float, angle: float) -> None:
    """Raise `InputError` if a chamfer does not fit between form circle and tip, or into half the tip."""

    def fits(trial: float) -> bool:
        roll = chamfer_start(gear, trial)
        return _above_form_point(gear, roll) and _chamfer_reaches(gear, roll, angle)

    def rises(trial: float) -> bool:
        return _chamfer_reaches(gear, chamfer_start(gear, _LOWEST * gear.normal_module), trial)

    _check("modification.tip_chamfer_angle", angle, FLATTEST, rises, _ANGLE)
    _check("modification.tip_chamfer", height, 0.0, fits, _CHAMFER)


def _check(field: str, value: float, least: float, fits: Callable[[float], bool], advice: Words) -> None:
    """Refuse a value that does not fit, naming the largest that does."""
    if fits(value):
        return
    low, high = least, value
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if fits(middle) else (low, middle)
    within(field, value, least, low, advice)


def _above_form_point(gear: Tooth, roll: float) -> bool:
    return gear.sign * (roll - gear.form_roll_length) > 0.0


def _rounding_angle(gear: Tooth, roll: float, radius: float) -> float:
    """Angle in rad from the tooth's center line to where the rounding meets the tip circle."""
    center = roll - gear.sign * radius
    rolled = roll / gear.base_radius - math.atan2(center, gear.base_radius)
    return gear.base_thickness_half_angle - gear.sign * rolled


def _chamfer_reaches(gear: Tooth, roll: float, angle: float) -> bool:
    """Whether a chamfer meets the tip circle on its own side of the tooth."""
    at = gear.sign * np.array([roll])
    point = involute_point(gear.base_radius, gear.base_thickness_half_angle, at)[0]
    normal = involute_normal(gear.base_radius, gear.base_thickness_half_angle, at)[0]
    upwards = gear.sign * np.array([-normal[1], normal[0]])
    along = math.cos(angle) * upwards - math.sin(angle) * normal
    rise = float(point @ along)
    square = rise**2 + gear.tip_radius**2 - float(point @ point)
    if square < 0.0:
        return False
    end = point + (gear.sign * math.sqrt(square) - rise) * along
    return float(end[0]) >= 0.0
