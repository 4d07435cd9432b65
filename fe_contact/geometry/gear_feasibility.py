"""Refusal of gears that cannot exist, with the standard's term for the defect."""

from __future__ import annotations

import math

import numpy as np

from bounds import LIMIT_SLACK, Quantity, Text, above, at_least, below, from_to
from fe_contact.body import CLAMPED, GearBlank
from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry.toothing import Toothing

THINNEST_RIM = 0.5
"""Least thickness of a rim under the root circle, in normal modules."""

THINNEST_WEB = 0.02
"""Least thickness of a web, in face widths."""

_ROUNDING = 1e-9
"""Fraction of the face width by which a web may exceed the face: rounding of units."""

_FILLET_POINTS = 65
"""Points of the trochoid at which the thickness of an undercut root is checked."""

SMALLEST_SECTOR = 5
"""Fewest teeth of a sector: three that may be loaded, and one beside each cut plane."""


def refuse_bore(gear: Toothing) -> None:
    """Refuse a bore that leaves no rim under the teeth."""
    bore = 2.0 * gear.seat_radius
    if bore >= 2.0 * gear.root_radius:
        bound = below(2.0 * gear.root_radius, "m", "the root diameter")
        remedy = "Lower the bore or add teeth."
        raise InfeasibleGeometry("bore", "bore_diameter", bore, bound, remedy)


def refuse_rim(gear: Toothing, blank: GearBlank) -> None:
    """Refuse a hub inside the bore, a rim that leaves no web, and one that carries no teeth."""
    bore = 2.0 * gear.seat_radius
    hub = bore if blank.hub_diameter is None else blank.hub_diameter
    if hub < bore:
        bound = at_least(bore, "m", "the bore diameter")
        raise InfeasibleGeometry("hub", "blank.hub_diameter", hub, bound, "Raise it or leave it out.")
    minimum, deepest = THINNEST_RIM * gear.normal_module, gear.root_radius - 0.5 * hub
    if deepest <= minimum:
        field = "bore_diameter" if blank.hub_diameter is None else "blank.hub_diameter"
        widest = 2.0 * (gear.root_radius - minimum)
        bound = below(widest, "m", note=f", which leaves a rim of {THINNEST_RIM:g} normal modules")
        raise InfeasibleGeometry("rim", field, hub, bound, "Leave the blank out for a solid gear.")
    if not blank.rim_thickness < deepest:
        bound = below(deepest, "m", note=", the depth between root circle and hub (or bore)")
        remedy = "Lower the rim thickness or the hub diameter; leave the blank out for a solid gear."
        raise InfeasibleGeometry("rim", "blank.rim_thickness", blank.rim_thickness, bound, remedy)
    if blank.rim_thickness < minimum * (1.0 - LIMIT_SLACK):
        bound = at_least(minimum, "m", note=f", {THINNEST_RIM:g} normal modules")
        raise InfeasibleGeometry(
            "rim", "blank.rim_thickness", blank.rim_thickness, bound, "Raise the rim thickness."
        )


def refuse_web(gear: Toothing, blank: GearBlank) -> None:
    """Refuse a web that is a foil, or that leaves the face."""
    minimum = THINNEST_WEB * gear.face_width
    if not minimum * (1.0 - LIMIT_SLACK) <= blank.web_thickness <= (1.0 + _ROUNDING) * gear.face_width:
        bound = from_to(minimum, gear.face_width, "m", "the face width")
        remedy = "A web as thick as the face is wide is a solid gear."
        raise InfeasibleGeometry("web", "blank.web_thickness", blank.web_thickness, bound, remedy)
    room = 0.5 * (gear.face_width - blank.web_thickness)
    if abs(blank.web_offset) > room + _ROUNDING * gear.face_width:
        bound = from_to(-room, room, "m", note=", so that the web stays within the face")
        remedy = "Lower the offset or the web thickness."
        raise InfeasibleGeometry("web", "blank.web_offset", blank.web_offset, bound, remedy)


def refuse_sector(gear: Toothing, teeth: int | None) -> None:
    """Refuse a sector that is not centered on a tooth, is the whole gear, or has a web or a seat."""
    if teeth is None:
        return
    if teeth % 2 == 0 or teeth >= gear.teeth:
        bound = f"odd and below the {gear.teeth} teeth"
        raise InfeasibleGeometry("sector", "sector_teeth", teeth, bound, "Leave it out for the whole gear.")
    if gear.web is not None or gear.seat != CLAMPED:
        bound = "left out with a web or a seat of the bore"
        raise InfeasibleGeometry("sector", "sector_teeth", teeth, bound, "A sector is solid, its bore fixed.")


def refuse_undercut(gear: Toothing) -> None:
    """Refuse a tip circle or a fillet that leaves no involute, or no material in the tooth's root."""
    remedy = "Raise the tip diameter, the profile shift or the number of teeth, or lower the dedendum."
    if gear.form_radius >= gear.tip_radius:
        name = "undercut" if gear.form_point.undercut else "tip diameter"
        bound = above(2.0 * gear.form_radius, "m", "the form diameter", ", where the fillet ends")
        raise InfeasibleGeometry(name, "tip_diameter", 2.0 * gear.tip_radius, bound, remedy)
    angles = np.linspace(gear.form_point.tool_angle, 0.5 * math.pi, _FILLET_POINTS)
    # the first coordinate is the distance from the middle line of the tooth
    if gear.form_point.undercut and np.min(gear.trochoid.point(angles)[:, 0]) <= 0.0:
        larger = "larger: the fillets of both flanks cut the tooth off"
        raise InfeasibleGeometry(
            "undercut", "profile_shift_coefficient", gear.profile_shift_coefficient, larger, remedy
        )


def refuse_pointed_tooth(gear: Toothing) -> None:
    """Refuse a tooth whose flanks meet below its tip circle."""
    if gear.tip_tooth_thickness <= 0.0:
        thickness = Quantity(gear.tip_tooth_thickness, "m", digits=3)
        bound = Text.of("smaller: the transverse tip thickness is ", thickness)
        remedy = "Lower the tip diameter, the addendum or the profile shift."
        raise InfeasibleGeometry("pointed tooth", "tip_diameter", 2.0 * gear.tip_radius, bound, remedy)
