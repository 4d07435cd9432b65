"""Backlash, and the center distance and profile shift sum without it (ISO 21771-1, clause 5.5).

Two involute teeth mesh without backlash when their thicknesses at the operating pitch circles fill the pitch.
Multiplied by the cosine of the working pressure angle, all lengths become arcs of the base circles.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fe_contact.errors import InfeasibleGeometry
from fe_contact.involute import inverse_involute, involute_function

if TYPE_CHECKING:
    from fe_contact.geometry.toothing import Toothing


_LARGER = (
    "larger: the teeth are too thin to mesh without backlash at any center distance",
    "Raise x_1 + x_2.",
)
_SMALLER = (
    "smaller: the teeth are too thick for the ring's spaces at any center distance",
    "Lower x_1 + x_2.",
)


def base_radius_sum(pinion: Toothing, wheel: Toothing) -> float:
    """r_b1 + r_b2 in m; r_b1 - r_b2, which is negative, for a ring gear."""
    return pinion.base_radius + wheel.sign * wheel.base_radius


def working_pressure_angle(pinion: Toothing, wheel: Toothing, center_distance: float) -> float:
    """Transverse working pressure angle alpha_wt at a center distance in m, rad."""
    return math.acos(abs(base_radius_sum(pinion, wheel)) / center_distance)


def base_circle_backlash(pinion: Toothing, wheel: Toothing, working_pressure_angle: float) -> float:
    """Backlash in m along the transverse line of action; negative if the teeth jam.

    One formula for external and internal pairs: with a ring gear the sum of base radii is negative, and so is
    the involute in the ring's thickness at its base circle.
    """
    radii = base_radius_sum(pinion, wheel)
    teeth = pinion.base_tooth_thickness + wheel.base_tooth_thickness
    return pinion.base_pitch - teeth + 2.0 * radii * involute_function(working_pressure_angle)


def tight_center_distance(pinion: Toothing, wheel: Toothing) -> float:
    """Center distance in m at which the teeth, as thick as they are, have no backlash.

    Raises `InfeasibleGeometry`: "profile shift sum": teeth too thin (internal: too thick) to touch both
    flanks at any distance.
    """
    radii = base_radius_sum(pinion, wheel)
    teeth = pinion.base_tooth_thickness + wheel.base_tooth_thickness
    return _distance_at(pinion, wheel, (teeth - pinion.base_pitch) / (2.0 * radii))


def reference_center_distance(pinion: Toothing, wheel: Toothing) -> float:
    """Center distance in m without backlash if neither gear had a thickness allowance.

    inv(alpha_wt) = inv(alpha_t) + 2 tan(alpha_n) (x_1 + x_2) / (z_1 + z_2). Raises `InfeasibleGeometry`:
    "profile shift sum": no such distance.
    """
    shift = 2.0 * math.tan(pinion.normal_pressure_angle) * shift_sum(pinion, wheel)
    involute = involute_function(pinion.transverse_pressure_angle)
    return _distance_at(pinion, wheel, involute + shift / (pinion.teeth + wheel.sign * wheel.teeth))


def shift_sum(pinion: Toothing, wheel: Toothing) -> float:
    """x_1 + x_2."""
    return pinion.profile_shift_coefficient + wheel.profile_shift_coefficient


def tight_shift_sum(pinion: Toothing, wheel: Toothing, working_pressure_angle: float) -> float:
    """Sum of the profile shift coefficients that would leave no backlash, thickness allowances kept."""
    backlash = base_circle_backlash(pinion, wheel, working_pressure_angle)
    thickening = 2.0 * pinion.transverse_module * math.tan(pinion.normal_pressure_angle)
    return shift_sum(pinion, wheel) + backlash / (thickening * math.cos(pinion.transverse_pressure_angle))


def _distance_at(pinion: Toothing, wheel: Toothing, involute: float) -> float:
    """Center distance whose working pressure angle has this involute function."""
    if involute < 0.0:
        bound, remedy = _LARGER if wheel.sign > 0 else _SMALLER
        total = shift_sum(pinion, wheel)
        raise InfeasibleGeometry("profile shift sum", "profile_shift_coefficient", total, bound, remedy)
    return abs(base_radius_sum(pinion, wheel)) / math.cos(inverse_involute(involute))
