"""The tip edge of a gear: sharp, rounded or chamfered (tip corner of ISO 21771-1)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bounds import Declared, Direction, Kind, SiNote, Text, Wording, between, declared
from fe_contact.errors import InputError, within
from fe_contact.flank.part import FlankPart, ReliefStart
from fe_contact.flank.tooth import Tooth
from fe_contact.involute import involute_normal, involute_point
from fe_contact.types import FloatArray

FLATTEST, STEEPEST = math.radians(5.0), math.radians(85.0)
"""Angles between flank and chamfer, rad; a flatter one is a relief."""
_HALVINGS = 50
_LOWEST = 1e-3  # of the normal module: a chamfer so low fits at any angle at which it reaches the tip circle
_ROUNDING_FITS = Text.of("It must leave an involute and some of the tip. ", SiNote("In m: 0.2 mm is 2e-4."))
_CHAMFER_RISES = Text.of("The chamfer must run on towards the tip circle. ", SiNote("In rad, to the flank."))
_CHAMFER_FITS = "It must leave an involute and some of the tip; at a smaller angle it takes less of the tip."
_ROUNDING = "Radius of the rounded tip edge in the transverse plane, tangent to flank and tip circle"
_CHAMFER = "Radial height h_K of the tip chamfer: d_Fa = d_a - 2 h_K (a ring gear: +)"
_ANGLE = "Angle between flank and tip chamfer at the tip form point in the transverse plane"


def _rounding_start(gear: Tooth, radius: float) -> float:
    """Roll length in m of the tip form point of a rounding that touches involute and tip circle.

    Its center lies on the normal of the tip form point, `radius` inside the tooth, and as far from the tip
    circle; NaN where there is none.
    """
    center = gear.tip_radius - gear.sign * radius
    if center < gear.base_radius:
        return math.nan
    return math.sqrt(center**2 - gear.base_radius**2) + gear.sign * radius


def _chamfer_start(gear: Tooth, height: float) -> float:
    """Roll length in m of the tip form point of a chamfer that starts `height` from the tip circle."""
    radius = gear.tip_radius - gear.sign * height
    return math.nan if radius < gear.base_radius else gear.roll_length(radius)


def _check_rounding(gear: Tooth, radius: float) -> None:
    """Raise `InputError` if a rounding does not fit between form circle and tip, or into half the tip."""

    def fits(trial: float) -> bool:
        roll = _rounding_start(gear, trial)
        return _above_form_point(gear, roll) and _rounding_angle(gear, roll, trial) >= 0.0

    _check("modification.tip_rounding", radius, 0.0, fits, _ROUNDING_FITS)


def _check_chamfer(gear: Tooth, height: float, angle: float) -> None:
    """Raise `InputError` if a chamfer does not fit between form circle and tip, or into half the tip."""

    def fits(trial: float) -> bool:
        roll = _chamfer_start(gear, trial)
        return _above_form_point(gear, roll) and _chamfer_reaches(gear, roll, angle)

    def rises(trial: float) -> bool:
        return _chamfer_reaches(gear, _chamfer_start(gear, _LOWEST * gear.normal_module), trial)

    _check("modification.tip_chamfer_angle", angle, FLATTEST, rises, _CHAMFER_RISES)
    _check("modification.tip_chamfer", height, 0.0, fits, _CHAMFER_FITS)


def _check(field: str, value: float, minimum: float, fits: Callable[[float], bool], remedy: Wording) -> None:
    """Refuse a value that does not fit, naming the largest that does."""
    if fits(value):
        return
    low, high = minimum, value
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if fits(middle) else (low, middle)
    within(field, value, minimum, low, remedy)


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


def _edge(description: str, example: float) -> Declared:
    """Return the declaration of the size of an edge, m."""
    return Declared(Kind.EDGE, "m", between(0.0, 0.1), description, example, Direction.PROFILE)


@dataclass(frozen=True, kw_only=True)
class CutTip(FlankPart):
    """A rounding or a chamfer, or a sharp tip edge; amounts at the tip stay those at the tip circle."""

    tip_rounding: float = declared(0.0, _edge(_ROUNDING, 0.3e-3))
    tip_chamfer: float = declared(0.0, _edge(_CHAMFER, 0.4e-3))
    tip_chamfer_angle: float = declared(
        math.radians(30.0),
        Declared(
            Kind.ANGLE, "rad", between(FLATTEST, STEEPEST), _ANGLE, math.radians(30.0), Direction.PROFILE
        ),
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.tip_rounding and self.tip_chamfer:
            remedy = "The tip has a rounding or a chamfer: give one of them."
            raise InputError("tip_chamfer", self.tip_chamfer, "0 where the tip has a rounding", remedy)

    def check_fits(self, gear: Tooth) -> None:
        """Raise `InputError` if the edge leaves no involute or no tip."""
        if self.tip_rounding:
            _check_rounding(gear, self.tip_rounding)
        if self.tip_chamfer:
            _check_chamfer(gear, self.tip_chamfer, self.tip_chamfer_angle)

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        (edge,) = self.relief_starts(gear)
        start = edge.roll_length
        # arc length of the flank from the tip form point on
        along = gear.sign * (roll_length - start) * (roll_length + start) / (2.0 * gear.base_radius)
        inside = np.maximum(along, 0.0)
        return np.asarray(inside * (edge.jump + 0.5 * edge.bend * inside))

    def relief_starts(self, gear: Tooth, face_position: FloatArray | float = 0.0) -> tuple[ReliefStart, ...]:
        """Return where the edge begins.

        The involute turns away from its tangent too, with the curvature 1/l; hollow in a ring gear.
        """
        if self.tip_rounding:
            start = _rounding_start(gear, self.tip_rounding)
            jump, bend = 0.0, 1.0 / self.tip_rounding - gear.sign / start
        else:
            start = _chamfer_start(gear, self.tip_chamfer)
            jump, bend = math.tan(self.tip_chamfer_angle), -gear.sign / start
        return (ReliefStart(start, towards_tip=True, jump=jump, bend=bend, ends_flank=True),)
