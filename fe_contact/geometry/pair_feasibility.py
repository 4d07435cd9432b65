"""Refusal of pairs that cannot run, by the standard term for what is wrong."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from bounds import LIMIT_SLACK, FieldName, Quantity, SiNote, Text, Words, at_least, at_most, below, exactly
from fe_contact.errors import InfeasibleGeometry, declared_fields, finite
from fe_contact.flank.modification import UNMODIFIED
from fe_contact.geometry.backlash import (
    base_radius_sum,
    shift_sum,
    tight_center_distance,
    tight_shift_sum,
)
from fe_contact.geometry.printed_data import backlash_rounding

if TYPE_CHECKING:
    from fe_contact.geometry.parallel_axes import ParallelAxes
    from fe_contact.geometry.toothing import Toothing

# Interference of a tip edge with the mating fillet, off the line of action.


_SAMPLES = 513


def _fillet_penetration(pair: ParallelAxes, tip: Toothing, flank: Toothing) -> float:
    """Depth in m (arc) to which the edge of `tip` cuts the fillet of `flank`, both external; 0 if clear.

    The gears turn in conjugate motion. The edge is followed on both sides of the line of centers, from where
    it crosses the line of action; its path in the mate's frame is compared with the fillet at equal radius.
    """
    opening = math.atan2(tip.tip_roll_length, tip.base_radius)
    widest = abs(pair.working_pressure_angle - opening)
    polar = np.linspace(-widest, widest, _SAMPLES)  # of the edge, from the line of centers
    x = pair.center_distance - tip.tip_radius * np.cos(polar)
    y = -tip.tip_radius * np.sin(polar)
    roll_length = tip.tip_roll_length - tip.base_radius * (polar + opening - pair.working_pressure_angle)
    turned = (pair.common_tangent - roll_length) / flank.base_radius
    edge = pair.working_pressure_angle - turned + flank.base_thickness_half_angle - np.arctan2(y, x)
    radius = np.hypot(x, y)
    tool_angle = np.linspace(0.5 * math.pi, flank.form_point.tool_angle, _SAMPLES)
    fillet_radius = flank.trochoid.radius(tool_angle)
    fillet = np.interp(radius, fillet_radius, flank.trochoid.polar_angle(tool_angle))
    below_form = radius < flank.form_radius
    return float(np.max(radius * (fillet - edge), initial=0.0, where=below_form))


FILLET_SLACK = 1e-6  # of the normal module: the resolution of the sampled tip path
_HALVINGS = 40  # of the range in which the largest clear tip radius is searched
_EXTERNAL = "External gears mesh with equal module and pressure angle and opposite helix angle."
_INTERNAL = "A ring gear and its pinion mesh with equal module, pressure angle and helix angle."


def refuse_strangers(pinion: Toothing, wheel: Toothing) -> None:
    """Refuse gears that do not share module, pressure angle and helix angle."""
    compared = (
        ("normal module", "normal_module", wheel.normal_module, pinion.normal_module),
        (
            "pressure angle",
            "normal_pressure_angle",
            wheel.normal_pressure_angle,
            pinion.normal_pressure_angle,
        ),
        ("helix angle", "helix_angle", wheel.helix_angle, -wheel.sign * pinion.helix_angle),
    )
    for name, field, value, expected in compared:
        if not math.isclose(value, expected, rel_tol=1e-9, abs_tol=1e-12):
            advice = _EXTERNAL if wheel.sign > 0 else _INTERNAL
            bound = exactly(expected, ", to fit the pinion")
            raise InfeasibleGeometry(name, f"wheel.{field}", value, bound, advice)


def refuse_infeasible_pair(pair: ParallelAxes) -> None:
    """Raise `InfeasibleGeometry` if two external gears cannot run at their center distance."""
    declared_fields(pair)
    refuse_face_overlap(pair)
    refuse_jamming(pair)
    _refuse_contact_ratio(pair)
    refuse_short_flanks(pair)
    _refuse_tip_clearance(pair)
    _refuse_interference(pair)
    _refuse_fillet_interference(pair)


def refuse_face_overlap(pair: ParallelAxes) -> None:
    """Refuse gears that pass beside each other."""
    finite("axial_offset", pair.axial_offset, SiNote("In m: 5 mm is 0.005."))
    low, high = pair.common_face
    if high <= low:
        limit = 0.5 * (pair.pinion.face_width + pair.wheel.face_width)
        bound = below(limit, "m", note=" in size")
        raise InfeasibleGeometry("face overlap", "axial_offset", pair.axial_offset, bound)


def refuse_jamming(pair: ParallelAxes) -> None:
    """Refuse teeth that jam by more than rounding of printed data makes."""
    pinion, wheel = pair.pinion, pair.wheel
    touching = pair.center_distance <= abs(base_radius_sum(pinion, wheel))
    if not touching and pair.transverse_base_backlash >= 0.0:
        return
    tight = tight_center_distance(pinion, wheel)
    bound = (at_most if pair.internal else at_least)(tight, "m", note=", where the teeth jam")
    distance = Quantity(tight, "m", side="high" if pair.internal else "low")
    advice = Text.of("Without backlash: ", FieldName("center_distance"), " = ", distance)
    if not touching:
        largest = Quantity(tight_shift_sum(pinion, wheel, pair.working_pressure_angle), side="high")
        instead = Text.of(largest, " instead of ", Quantity(shift_sum(pinion, wheel)))
        advice = Text.of(advice, ", or x_1 + x_2 = ", instead, ". ", _beyond_rounding(pair))
    advice = Text.of(advice, ".")
    raise InfeasibleGeometry("profile shift sum", "center_distance", pair.center_distance, bound, advice)


def _beyond_rounding(pair: ParallelAxes) -> Text:
    """Say how large a jam is beside what rounding of printed data makes."""
    jam, rounding = (
        -pair.transverse_base_backlash,
        backlash_rounding(pair.pinion, pair.wheel, pair.center_distance),
    )
    most = Text.of("rounding of the printed values makes ", Quantity(rounding, "m", digits=2), " at most")
    return Text.of("Jam ", Quantity(jam, "m", digits=3), "; ", most)


def _refuse_contact_ratio(pair: ParallelAxes) -> None:
    """Refuse a pair that loses contact between one tooth pair and the next."""
    if pair.total_contact_ratio < 1.0:
        value = pair.total_contact_ratio
        if pair.overlap_ratio == 0.0:
            value = pair.transverse_contact_ratio
        bound = f"smaller: the contact ratio is {value:.6g}, below 1"
        advice = "Lower the center distance, or raise the tip diameters or the number of teeth."
        raise InfeasibleGeometry("contact ratio", "center_distance", pair.center_distance, bound, advice)


def refuse_short_flanks(pair: ParallelAxes) -> None:
    """Refuse tip edges that end the usable flanks before the next tooth pair is in contact."""
    value = pair.active_contact_ratio + pair.overlap_ratio
    if value >= 1.0:
        return
    gears = {"pinion": pair.pinion, "wheel": pair.wheel}
    name = max(gears, key=lambda each: abs(gears[each].tip_roll_length - gears[each].tip_form_roll_length))
    shape = gears[name].modification
    field = "tip_rounding" if shape.tip_rounding else "tip_chamfer"
    bound = f"smaller: between the tip form circles the contact ratio is {value:.6g}, below 1"
    raise InfeasibleGeometry("contact ratio", f"{name}.modification.{field}", getattr(shape, field), bound)


def _refuse_tip_clearance(pair: ParallelAxes) -> None:
    """Refuse a tip circle that reaches the mating root circle."""
    gears = (("pinion", pair.pinion, pair.wheel), ("wheel", pair.wheel, pair.pinion))
    for name, gear, mate in gears:
        largest = pair.center_distance - mate.root_radius
        if gear.tip_radius >= largest:
            bound = below(2.0 * largest, "m", note=", where the tip reaches the mating root circle")
            advice = "Lower the tip diameter or the addendum, or raise the mate's dedendum."
            raise InfeasibleGeometry(
                "tip clearance", f"{name}.tip_diameter", 2.0 * gear.tip_radius, bound, advice
            )


def _refuse_interference(pair: ParallelAxes) -> None:
    """Refuse a tip that meets the mating flank below its form point, where it is no involute."""
    gears = (("pinion", pair.pinion, pair.wheel), ("wheel", pair.wheel, pair.pinion))
    for name, gear, mate in gears:
        lowest = pair.common_tangent - gear.tip_roll_length  # on the mate
        if lowest < mate.form_roll_length * (1.0 - LIMIT_SLACK):
            reason = "where the tip meets the mating form circle"
            advice = "Lower the tip diameter or the addendum, or raise the mate's profile shift or dedendum."
            _refuse_long_tip(pair, name, gear, reason, advice)


def _refuse_fillet_interference(pair: ParallelAxes) -> None:
    """Refuse a tip that cuts the mating fillet on its way through the tooth space."""
    gears = (("pinion", pair.pinion, pair.wheel), ("wheel", pair.wheel, pair.pinion))
    for name, gear, mate in gears:
        depth = _fillet_penetration(pair, gear, mate)
        if depth > FILLET_SLACK * gear.normal_module:
            cut = Quantity(depth, "m", digits=3)
            reason = Text.of("the tip cuts the mating fillet by ", cut, " off the line of action")
            advice = "Lower the tip diameter or the addendum, or the mate's root radius."
            _refuse_long_tip(pair, name, gear, reason, advice)


def _refuse_long_tip(pair: ParallelAxes, name: str, gear: Toothing, reason: Words, advice: str) -> NoReturn:
    """Refuse a tip diameter, and say which one is clear of the mating flank and fillet."""
    mate = pair.wheel if gear is pair.pinion else pair.pinion
    largest = _largest_clear_tip(pair, gear, mate)
    bound = (
        Text.of("smaller: ", reason) if largest is None else at_most(largest, "m", note=Text.of(", ", reason))
    )
    raise InfeasibleGeometry("interference", f"{name}.tip_diameter", 2.0 * gear.tip_radius, bound, advice)


def _largest_clear_tip(pair: ParallelAxes, gear: Toothing, mate: Toothing) -> float | None:
    """Return the largest tip diameter in m that interferes nowhere, None if even the form diameter does."""
    reach = max(pair.common_tangent - mate.form_roll_length, 0.0)
    low, high = gear.form_radius, min(gear.tip_radius, math.hypot(gear.base_radius, reach))

    def cuts(radius: float) -> bool:
        tip_diameter = 2.0 * radius
        shorter = replace(gear, tip_diameter=tip_diameter, modification=UNMODIFIED)
        return _fillet_penetration(pair, shorter, mate) > FILLET_SLACK * gear.normal_module

    low += 1e-6 * gear.normal_module
    if high <= low or cuts(low):
        return None
    if not cuts(high):
        return 2.0 * high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if cuts(middle) else (middle, high)
    return 2.0 * low
