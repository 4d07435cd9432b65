"""Refusal of ring gears that cannot exist or cannot be cut, with the standard's term for the defect."""

from __future__ import annotations

import math

from bounds import LIMIT_SLACK, Quantity, Text, above, at_least, below
from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry.pinion_cutter import PinionCutter
from fe_contact.geometry.toothing import Toothing
from fe_contact.geometry.trimming import radial_clearance

_OTHER_CUTTER = "Choose another number of teeth or profile shift of the cutter."


def refuse_shift_sum_of_cutter(gear: Toothing, teeth: int, profile_shift: float, involute: float) -> None:
    """Refuse a cutter too thick for the tooth space at any center distance (`involute` below 0)."""
    if involute <= 0.0:
        angle = math.tan(gear.transverse_pressure_angle) - gear.transverse_pressure_angle
        largest = angle * (gear.teeth - teeth) / (2.0 * math.tan(gear.normal_pressure_angle))
        limit = largest - gear.generating_shift_coefficient
        raise InfeasibleGeometry(
            "profile shift sum",
            "cutter_profile_shift_coefficient",
            profile_shift,
            below(limit, note=", where the cutter fills the tooth space"),
            _OTHER_CUTTER,
        )


def refuse_narrow_rim(gear: Toothing) -> None:
    """Refuse a rim whose outside is not beyond the root circle."""
    rim = 2.0 * gear.seat_radius
    if rim <= 2.0 * gear.root_radius:
        bound = above(2.0 * gear.root_radius, "m", "the root diameter")
        raise InfeasibleGeometry("rim", "rim_diameter", rim, bound, "Raise the rim diameter.")


def refuse_tip_diameter(gear: Toothing, cutter: PinionCutter) -> None:
    """Refuse a tip circle beyond the involute at the fillet, or inside what the cutter's involute reaches."""
    if gear.tip_radius >= gear.form_radius:
        bound = below(2.0 * gear.form_radius, "m", "the form diameter", ", where the fillet begins")
        raise InfeasibleGeometry("tip diameter", "tip_diameter", 2.0 * gear.tip_radius, bound)
    smallest = math.hypot(gear.base_radius, cutter.common_tangent)
    if gear.tip_radius < smallest * (1.0 - LIMIT_SLACK):
        bound = at_least(2.0 * smallest, "m", note=", where the cutter's involute ends at its base circle")
        remedy = f"Raise the tip diameter, or lower the addendum or the profile shift. {_OTHER_CUTTER}"
        name = "tip diameter" if gear.tip_radius < gear.base_radius else "interference"
        raise InfeasibleGeometry(name, "tip_diameter", 2.0 * gear.tip_radius, bound, remedy)


def refuse_rounding(gear: Toothing, cutter: PinionCutter) -> None:
    """Refuse a rounding that does not fit on the cutter's tip."""
    if cutter.corner_angle < 0.0 or cutter.corner_center_radius < cutter.base_radius:
        bound = "smaller: the rounding does not fit between the two flanks of the cutter's tooth"
        remedy = "Lower the root radius or the dedendum."
        raise InfeasibleGeometry(
            "root radius", "root_radius_coefficient", gear.root_radius_coefficient, bound, remedy
        )


def refuse_cut_tips(gear: Toothing, cutter: PinionCutter) -> None:
    """Refuse a cutter that trims the tips it passes while it is fed in radially."""
    at_tips = (
        math.acos(cutter.base_radius / cutter.tip_radius),
        math.acos(min(1.0, gear.base_radius / gear.tip_radius)),
    )
    if radial_clearance(cutter.ratio, at_tips, cutter.working_pressure_angle) < 0.0:
        bound = "smaller: the cutter would trim the ring's tips while it is fed in"
        remedy = "Lower the cutter's number of teeth, or raise the tip diameter."
        raise InfeasibleGeometry("trimming interference", "cutter_teeth", cutter.teeth, bound, remedy)


def refuse_pointed_tooth(gear: Toothing) -> None:
    """Refuse a tooth whose flanks meet before its tip circle."""
    if gear.tip_tooth_thickness <= 0.0:
        thickness = Quantity(gear.tip_tooth_thickness, "m", digits=3)
        bound = Text.of("larger: the transverse tip thickness is ", thickness)
        remedy = "Raise the tip diameter, or lower the addendum."
        raise InfeasibleGeometry("pointed tooth", "tip_diameter", 2.0 * gear.tip_radius, bound, remedy)
