"""What carries the teeth: bore or rim, rim and web of the gear body, and the material."""

from __future__ import annotations

from dataclasses import dataclass

from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.placement import u_on_shaft
from lineofaction.gearbox.from_rexs.tooth_depth import ToothDepth
from lineofaction.gearbox.from_rexs.toothing import ToothingData
from lineofaction.gearbox.units import GPA, MM

_RING_RIM = 3.5  # normal modules: from there on the rim of a ring gear has no influence, ISO 6336-3, clause 9
_THINNEST = 1.0  # normal modules between bore and root circle; less is one piece with the shaft
_INTEGRAL = 0.5  # of the root diameter
STEEL = (210e9, 0.3)


@dataclass(frozen=True)
class Blank:
    """Rim and web of a gear's body, m."""

    rim_thickness: float
    web_thickness: float


def root_diameter(gear: ToothingData, depth: ToothDepth, shift: float) -> float:
    """Return d_f = d - 2 m_n (h_fP - x) in m, of a ring gear d + 2 m_n (h_fP - x)."""
    height = depth.dedendum_coefficient - shift
    return gear.reference_diameter - 2.0 * gear.sign * gear.normal_module * height


def held_diameter(unit: GearUnit, gear: ToothingData, root: float) -> float:
    """Return the bore of an external gear, the outside of a ring gear's rim, m.

    Parameters
    ----------
    root : float
        Root diameter, m.
    """
    return _rim_diameter(unit, gear, root) if gear.sign < 0 else _bore(unit, gear, root)


def _rim_diameter(unit: GearUnit, gear: ToothingData, root: float) -> float:
    for part in (gear.part, *bodies(unit, gear.part)):
        value = part.number("outer_diameter", "rim_diameter_mm")
        if value is not None and value > root:
            return value
    rim = root + 2.0 * _RING_RIM * gear.normal_module
    words = f"rim_diameter_mm {rim / MM:.7g} = d_f + 2 * {_RING_RIM} m_n: the file gives no rim"
    gear.part.say("outer_diameter", "defaulted", words)
    return rim


def _bore(unit: GearUnit, gear: ToothingData, root: float) -> float:
    """Return the bore: the gear's or its body's own, else the shaft's outside, else half the root circle."""
    largest = root - 2.0 * _THINNEST * gear.normal_module
    for part in (gear.part, *bodies(unit, gear.part)):
        value = part.number("inner_diameter", "bore_diameter_mm")
        if value is not None and 0.0 < value < root:
            return value
    shaft = _shaft_diameter(unit, gear.part)
    if shaft is not None and shaft <= largest:
        words = f"bore_diameter_mm {shaft / MM:.7g}: the shaft's outer diameter there"
        gear.part.say("inner_diameter", "derived", words)
        return shaft
    bore = _INTEGRAL * root
    why = "no bore and no shaft section" if shaft is None else "one piece with its shaft"
    words = f"bore_diameter_mm {bore / MM:.7g} = d_f / 2, within which nothing deflects: {why}"
    gear.part.say("inner_diameter", "defaulted", words)
    return bore


def _shaft_diameter(unit: GearUnit, gear: Part) -> float | None:
    """Return the outer diameter of the shaft's section at the gear's middle, m."""
    shaft, place = unit.owner(gear, "shaft"), u_on_shaft(unit, gear)
    if shaft is None or place is None:
        return None
    start = 0.0
    for section in unit.children(shaft, "shaft_section"):
        length = section.number("length", "length of the section") or 0.0
        begin = section.number("u_coordinate_on_shaft", "begin of the section")
        start = start if begin is None else begin
        if start <= place <= start + length:
            return _section_diameter(section, 0.0 if length == 0.0 else (place - start) / length)
        start += length
    return None


def _section_diameter(section: Part, fraction: float) -> float | None:
    """Return the outer diameter at a fraction of a section's length, m."""
    begin = section.number("outer_diameter_begin", "outer diameter of the section")
    end = section.number("outer_diameter_end", "outer diameter of the section")
    if begin is None or end is None:
        return begin if end is None else end
    return begin + fraction * (end - begin)


def bodies(unit: GearUnit, gear: Part) -> tuple[Part, ...]:
    """Return the bodies of a gear."""
    return unit.children(gear, "gear_body")


def blank_of(unit: GearUnit, gear: Part) -> Blank | None:
    """Return rim and web of a gear's body, None for a solid one."""
    for body in bodies(unit, gear):
        rim = body.number("gear_body_rim_thickness", "blank.rim_thickness_mm")
        web = body.number("gear_body_web_thickness", "blank.web_thickness_mm")
        if rim and web:
            return Blank(rim, web)
        if body.attribute("body_contour_coordinate_u") is not None:
            body.say("body_contour_coordinate_u", "ignored", "a solid body: contours have no place in a case")
    return None


def elasticity(unit: GearUnit, gear: Part) -> tuple[float, float]:
    """Return Young's modulus in Pa and Poisson's ratio: the gear's, its body's, its shaft's, else steel's."""
    shaft = unit.owner(gear, "shaft")
    owners = (gear, *bodies(unit, gear), *(() if shaft is None else (shaft,)))
    for owner in owners:
        for material in unit.related(owner, "reference", "origin", "referenced"):
            young = material.number("elastic_modulus", "youngs_modulus_gpa")
            if young is None:
                continue
            poisson = material.number("poisson_ratio", "poissons_ratio")
            if owner is not gear:
                gear.say("material", "derived", f"{material.name}, the material of {owner.name}")
            return young, STEEL[1] if poisson is None else poisson
    gear.say("material", "defaulted", f"steel, {STEEL[0] / GPA:g} GPa, {STEEL[1]:g}: the file names none")
    return STEEL
