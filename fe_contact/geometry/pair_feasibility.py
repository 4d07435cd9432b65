"""Refusal of pairs that cannot run, by the standard term for what is wrong."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fe_contact.checks import finite, positive
from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry.backlash import shift_sum, tight_center_distance, tight_shift_sum
from fe_contact.geometry.fillet_interference import fillet_penetration

if TYPE_CHECKING:
    from fe_contact.geometry.gear_pair import GearPair
    from fe_contact.geometry.parallel_axes import ParallelAxes
    from fe_contact.geometry.toothing import Toothing

FILLET_SLACK = 1e-6  # of the normal module: the resolution of the sampled tip path
BACKLASH_SLACK = 1e-6  # of the normal module: what rounding a centre distance to seven digits may cost
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
    for name, field, value, wanted in compared:
        if not math.isclose(value, wanted, rel_tol=1e-9, abs_tol=1e-12):
            advice = _EXTERNAL if wheel.sign > 0 else _INTERNAL
            raise InfeasibleGeometry(
                name, f"wheel.{field}", value, f"{wanted:.9g}, to fit the pinion", advice
            )


def refuse_infeasible_pair(pair: GearPair) -> None:
    """Raise `InfeasibleGeometry` if the two gears cannot run at their centre distance."""
    positive("center_distance", pair.center_distance, "In m: 80 mm is 0.08.")
    refuse_face_overlap(pair)
    _refuse_jamming(pair)
    _refuse_contact_ratio(pair)
    _refuse_tip_clearance(pair)
    _refuse_interference(pair)
    _refuse_fillet_interference(pair)


def refuse_face_overlap(pair: ParallelAxes) -> None:
    """Refuse gears that pass beside each other."""
    finite("axial_offset", pair.axial_offset, "In m: 5 mm is 0.005.")
    low, high = pair.common_face
    if high <= low:
        limit = 0.5 * (pair.pinion.face_width + pair.wheel.face_width)
        raise InfeasibleGeometry(
            "face overlap", "axial_offset", pair.axial_offset, f"less than {limit:.9g} m in size"
        )


def _refuse_jamming(pair: GearPair) -> None:
    """Refuse negative backlash."""
    pinion, wheel = pair.pinion, pair.wheel
    touching = pair.center_distance <= pinion.base_radius + wheel.base_radius
    if not touching and pair.transverse_base_backlash >= -BACKLASH_SLACK * pinion.normal_module:
        return
    distance = tight_center_distance(pinion, wheel)
    advice = f"Without backlash: center_distance = {distance:.9g} m"
    if not touching:
        tight_sum = tight_shift_sum(pinion, wheel, pair.working_pressure_angle)
        advice += f", or x_1 + x_2 = {tight_sum:.7g} instead of {shift_sum(pinion, wheel):.7g}"
    bound = f"at least {distance:.9g} m, where the teeth jam"
    raise InfeasibleGeometry(
        "profile shift sum", "center_distance", pair.center_distance, bound, f"{advice}."
    )


def _refuse_contact_ratio(pair: GearPair) -> None:
    """Refuse a pair that loses contact between one tooth pair and the next."""
    if pair.total_contact_ratio < 1.0:
        value = pair.total_contact_ratio
        if pair.overlap_ratio == 0.0:
            value = pair.transverse_contact_ratio
        bound = f"smaller: the contact ratio is {value:.6g}, below 1"
        advice = "Lower the centre distance, or raise the tip diameters or the number of teeth."
        raise InfeasibleGeometry("contact ratio", "center_distance", pair.center_distance, bound, advice)


def _refuse_tip_clearance(pair: GearPair) -> None:
    """Refuse a tip circle that reaches the mating root circle."""
    gears = (("pinion", pair.pinion, pair.wheel), ("wheel", pair.wheel, pair.pinion))
    for name, gear, mate in gears:
        largest = pair.center_distance - mate.root_radius
        if gear.tip_radius >= largest:
            bound = f"below {2.0 * largest:.9g} m, where the tip reaches the mating root circle"
            advice = "Lower the tip diameter or the addendum, or raise the mate's dedendum."
            raise InfeasibleGeometry(
                "tip clearance", f"{name}.tip_diameter", 2.0 * gear.tip_radius, bound, advice
            )


def _refuse_interference(pair: GearPair) -> None:
    """Refuse a tip that meets the mating flank below its form point, where it is no involute."""
    gears = (("pinion", pair.pinion, pair.wheel), ("wheel", pair.wheel, pair.pinion))
    for name, gear, mate in gears:
        lowest = pair.common_tangent - gear.tip_roll_length  # on the mate
        if lowest < mate.form_roll_length * (1.0 - 1e-12):
            reach = pair.common_tangent - mate.form_roll_length
            largest = 2.0 * math.hypot(gear.base_radius, max(reach, 0.0))
            bound = f"at most {largest:.9g} m, where the tip meets the mating form circle"
            advice = "Lower the tip diameter or the addendum, or raise the mate's profile shift or dedendum."
            raise InfeasibleGeometry(
                "interference", f"{name}.tip_diameter", 2.0 * gear.tip_radius, bound, advice
            )


def _refuse_fillet_interference(pair: GearPair) -> None:
    """Refuse a tip that cuts the mating fillet on its way through the tooth space."""
    gears = (("pinion", pair.pinion, pair.wheel), ("wheel", pair.wheel, pair.pinion))
    for name, gear, mate in gears:
        depth = fillet_penetration(pair, gear, mate)
        if depth > FILLET_SLACK * gear.normal_module:
            bound = f"smaller: the tip cuts the mating fillet by {depth:.3g} m off the line of action"
            advice = "Lower the tip diameter or the addendum, or the mate's root radius."
            raise InfeasibleGeometry(
                "interference", f"{name}.tip_diameter", 2.0 * gear.tip_radius, bound, advice
            )
