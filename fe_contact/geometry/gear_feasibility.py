"""Refusal of gears that cannot exist, by the standard term for what is wrong."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from bounds import Quantity, Text, above, below
from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry.bore_seat import refuse_misfit_seat
from fe_contact.geometry.gear_blank import refuse_misfit

if TYPE_CHECKING:
    from fe_contact.geometry.gear import Gear


def refuse_infeasible_gear(gear: Gear) -> None:
    """Raise `InfeasibleGeometry` if no such gear can be generated."""
    _refuse_bore(gear)
    refuse_misfit(gear)
    refuse_misfit_seat(gear)
    _refuse_undercut(gear)
    _refuse_pointed_tooth(gear)


def _refuse_bore(gear: Gear) -> None:
    """Refuse a bore that leaves no rim under the teeth."""
    if gear.bore_diameter >= 2.0 * gear.root_radius:
        bound = below(2.0 * gear.root_radius, "m", "the root diameter")
        advice = "Lower the bore or add teeth."
        raise InfeasibleGeometry("bore", "bore_diameter", gear.bore_diameter, bound, advice)


def _refuse_undercut(gear: Gear) -> None:
    """Refuse a tip circle or a fillet that leaves no involute, or no material in the tooth's root."""
    advice = "Raise the tip diameter, the profile shift or the number of teeth, or lower the dedendum."
    if gear.form_radius >= gear.tip_radius:
        name = "undercut" if gear.form_point.undercut else "tip diameter"
        bound = above(2.0 * gear.form_radius, "m", "the form diameter", ", where the fillet ends")
        raise InfeasibleGeometry(name, "tip_diameter", 2.0 * gear.tip_radius, bound, advice)
    angles = np.linspace(gear.form_point.tool_angle, 0.5 * math.pi, 65)
    if gear.form_point.undercut and np.min(gear.trochoid.point(angles)[:, 0]) <= 0.0:
        larger = "larger: the fillets of both flanks cut the tooth off"
        raise InfeasibleGeometry(
            "undercut", "profile_shift_coefficient", gear.profile_shift_coefficient, larger, advice
        )


def _refuse_pointed_tooth(gear: Gear) -> None:
    """Refuse a tooth whose flanks meet below the tip circle."""
    if gear.tip_tooth_thickness <= 0.0:
        thickness = Quantity(gear.tip_tooth_thickness, "m", digits=3)
        bound = Text.of("smaller: the transverse tip thickness is ", thickness)
        advice = "Lower the tip diameter, the addendum or the profile shift."
        raise InfeasibleGeometry("pointed tooth", "tip_diameter", 2.0 * gear.tip_radius, bound, advice)
