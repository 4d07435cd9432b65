"""Refusal of pairs that cannot run, with the standard's term for the defect."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NoReturn

from bounds import LIMIT_SLACK, FieldName, Quantity, SiNote, Text, Wording, at_least, at_most, below, exactly
from fe_contact.errors import InfeasibleGeometry, declared_fields, finite
from fe_contact.geometry.backlash import base_radius_sum, shift_sum, tight_center_distance, tight_shift_sum
from fe_contact.geometry.fillet_interference import FILLET_SLACK, fillet_penetration, largest_clear_tip
from fe_contact.geometry.printed_data import backlash_rounding
from fe_contact.geometry.ring_pair_feasibility import (
    refuse_internal_contact_ratio,
    refuse_internal_interference,
    refuse_internal_tip_clearance,
    refuse_short_distance,
    refuse_tip_interference,
    refuse_tooth_numbers,
    refuse_trochoidal_interference,
)

if TYPE_CHECKING:
    from fe_contact.geometry.parallel_axes import ParallelAxes
    from fe_contact.geometry.toothing import Toothing


_OPPOSITE_HANDS = "External gears mesh with equal module and pressure angle and opposite helix angle."
_SAME_HAND = "A ring gear and its pinion mesh with equal module, pressure angle and helix angle."


def refuse_strangers(pinion: Toothing, wheel: Toothing) -> None:
    """Refuse gears of a pair that differ in module, pressure or helix angle, and a ring gear too small."""
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
        if not math.isclose(value, expected, rel_tol=1e-9, abs_tol=1e-12):  # equal but for rounding of units
            remedy = _OPPOSITE_HANDS if wheel.sign > 0 else _SAME_HAND
            bound = exactly(expected, ", to fit the pinion")
            raise InfeasibleGeometry(name, f"wheel.{field}", value, bound, remedy)
    if wheel.sign < 0:
        refuse_tooth_numbers(pinion, wheel)


def refuse_infeasible_pair(pair: ParallelAxes) -> None:
    """Raise `InfeasibleGeometry` if two gears cannot run at their center distance."""
    declared_fields(pair)
    _refuse_face_overlap(pair)
    for refuse in _INTERNAL_CHECKS if pair.internal else _EXTERNAL_CHECKS:
        refuse(pair)


def _refuse_face_overlap(pair: ParallelAxes) -> None:
    """Refuse gears whose faces do not overlap."""
    finite("axial_offset", pair.axial_offset, SiNote("In m: 5 mm is 0.005."))
    low, high = pair.common_face
    if high <= low:
        limit = 0.5 * (pair.pinion.face_width + pair.wheel.face_width)
        bound = below(limit, "m", note=" in size")
        raise InfeasibleGeometry("face overlap", "axial_offset", pair.axial_offset, bound)


def _refuse_jamming(pair: ParallelAxes) -> None:
    """Refuse teeth that jam by more than rounding of printed data makes."""
    pinion, wheel = pair.pinion, pair.wheel
    touching = pair.center_distance <= abs(base_radius_sum(pinion, wheel))
    if not touching and pair.transverse_base_backlash >= 0.0:
        return
    tight = tight_center_distance(pinion, wheel)
    bound = (at_most if pair.internal else at_least)(tight, "m", note=", where the teeth jam")
    distance = Quantity(tight, "m", side="high" if pair.internal else "low")
    remedy = Text.of("Without backlash: ", FieldName("center_distance"), " = ", distance)
    if not touching:
        largest = Quantity(tight_shift_sum(pinion, wheel, pair.working_pressure_angle), side="high")
        instead = Text.of(largest, " instead of ", Quantity(shift_sum(pinion, wheel)))
        remedy = Text.of(remedy, ", or x_1 + x_2 = ", instead, ". ", _beyond_rounding(pair))
    remedy = Text.of(remedy, ".")
    raise InfeasibleGeometry("profile shift sum", "center_distance", pair.center_distance, bound, remedy)


def _beyond_rounding(pair: ParallelAxes) -> Text:
    """Return the text of how large a jam is against the rounding of printed data."""
    jam, rounding = (
        -pair.transverse_base_backlash,
        backlash_rounding(pair.pinion, pair.wheel, pair.center_distance),
    )
    allowance = Text.of(
        "rounding of the printed values makes ", Quantity(rounding, "m", digits=2), " at most"
    )
    return Text.of("Jam ", Quantity(jam, "m", digits=3), "; ", allowance)


def _refuse_contact_ratio(pair: ParallelAxes) -> None:
    if pair.total_contact_ratio < 1.0:
        value = pair.total_contact_ratio
        if pair.overlap_ratio == 0.0:
            value = pair.transverse_contact_ratio
        bound = f"smaller: the contact ratio is {value:.6g}, below 1"
        remedy = "Lower the center distance, or raise the tip diameters or the number of teeth."
        raise InfeasibleGeometry("contact ratio", "center_distance", pair.center_distance, bound, remedy)


def _refuse_short_flanks(pair: ParallelAxes) -> None:
    """Refuse tip edges that end the usable flanks before the next tooth pair is in contact."""
    value = pair.active_contact_ratio + pair.overlap_ratio
    if value >= 1.0:
        return
    gears = {"pinion": pair.pinion, "wheel": pair.wheel}
    name = max(gears, key=lambda gear: abs(gears[gear].tip_roll_length - gears[gear].tip_form_roll_length))
    shape = gears[name].modification
    field = "tip_rounding" if shape.tip_rounding else "tip_chamfer"
    bound = f"smaller: between the tip form circles the contact ratio is {value:.6g}, below 1"
    raise InfeasibleGeometry("contact ratio", f"{name}.modification.{field}", getattr(shape, field), bound)


def _refuse_tip_clearance(pair: ParallelAxes) -> None:
    gears = (("pinion", pair.pinion, pair.wheel), ("wheel", pair.wheel, pair.pinion))
    for name, gear, mate in gears:
        largest = pair.center_distance - mate.root_radius
        if gear.tip_radius >= largest:
            bound = below(2.0 * largest, "m", note=", where the tip reaches the mating root circle")
            remedy = "Lower the tip diameter or the addendum, or raise the mate's dedendum."
            raise InfeasibleGeometry(
                "tip clearance", f"{name}.tip_diameter", 2.0 * gear.tip_radius, bound, remedy
            )


def _refuse_interference(pair: ParallelAxes) -> None:
    """Refuse a tip that meets the mating flank below its form point, where it is no involute."""
    gears = (("pinion", pair.pinion, pair.wheel), ("wheel", pair.wheel, pair.pinion))
    for name, gear, mate in gears:
        lowest = pair.common_tangent - gear.tip_roll_length  # on the mate
        if lowest < mate.form_roll_length * (1.0 - LIMIT_SLACK):
            reason = "where the tip meets the mating form circle"
            remedy = "Lower the tip diameter or the addendum, or raise the mate's profile shift or dedendum."
            _refuse_long_tip(pair, name, gear, reason, remedy)


def _refuse_fillet_interference(pair: ParallelAxes) -> None:
    """Refuse a tip that cuts the mating fillet on its way through the tooth space."""
    gears = (("pinion", pair.pinion, pair.wheel), ("wheel", pair.wheel, pair.pinion))
    for name, gear, mate in gears:
        depth = fillet_penetration(pair, gear, mate)
        if depth > FILLET_SLACK * gear.normal_module:
            cut = Quantity(depth, "m", digits=3)
            reason = Text.of("the tip cuts the mating fillet by ", cut, " off the line of action")
            remedy = "Lower the tip diameter or the addendum, or the mate's root radius."
            _refuse_long_tip(pair, name, gear, reason, remedy)


def _refuse_long_tip(pair: ParallelAxes, name: str, gear: Toothing, reason: Wording, remedy: str) -> NoReturn:
    """Refuse a tip diameter, and say which one is clear of the mating flank and fillet."""
    mate = pair.wheel if gear is pair.pinion else pair.pinion
    largest = largest_clear_tip(pair, gear, mate)
    bound = (
        Text.of("smaller: ", reason) if largest is None else at_most(largest, "m", note=Text.of(", ", reason))
    )
    raise InfeasibleGeometry("interference", f"{name}.tip_diameter", 2.0 * gear.tip_radius, bound, remedy)


_EXTERNAL_CHECKS = (
    _refuse_jamming,
    _refuse_contact_ratio,
    _refuse_short_flanks,
    _refuse_tip_clearance,
    _refuse_interference,
    _refuse_fillet_interference,
)
_INTERNAL_CHECKS = (
    refuse_short_distance,
    _refuse_jamming,
    refuse_internal_tip_clearance,
    refuse_internal_contact_ratio,
    _refuse_short_flanks,
    refuse_internal_interference,
    refuse_tip_interference,
    refuse_trochoidal_interference,
)
