"""The body that carries the teeth: bore or rim, rim and web, and the material."""

from __future__ import annotations

from typing import Any

from lineofaction.gearbox.from_rexs.gear_unit import Part, rounded
from lineofaction.gearbox.from_rexs.placement import u_on_shaft
from lineofaction.gearbox.from_rexs.toothing import ToothingData
from lineofaction.gearbox.units import GPA, MM

RIM = 3.5
"""Normal modules: thinner rims weaken the tooth root, thicker have no influence (ISO 6336-3, clause 9)."""

_THINNEST = 1.0  # normal modules between bore and root circle; a thinner gear is one piece with its shaft

_INTEGRAL = 0.5  # bore over root diameter of a gear without a stated bore

STEEL = (210e9, 0.3)
"""Young's modulus, Pa, and Poisson's ratio of steel."""

Table = dict[str, Any]


def rim_diameter(gear: ToothingData, root: float) -> float:
    """Return the diameter of a ring gear's rim, m; one of the usual thickness where the file gives none."""
    for part in (gear.part, *gear.part.children("gear_body")):
        value = part.number("outer_diameter", "rim_diameter_mm")
        if value is not None and value > root:
            return value
    rim = root + 2.0 * RIM * gear.normal_module
    text = f"rim_diameter_mm {rim / MM:.7g} = d_f + 2 * {RIM} m_n: the file gives no rim"
    gear.part.say("outer_diameter", "defaulted", text)
    return rim


def bore(gear: ToothingData, root: float) -> float:
    """Return the bore: the gear's or its body's own, else the shaft's outside, else half the root circle."""
    largest = root - 2.0 * _THINNEST * gear.normal_module
    for part in (gear.part, *gear.part.children("gear_body")):
        value = part.number("inner_diameter", "bore_diameter_mm")
        if value is not None and 0.0 < value < root:
            return value
    shaft = _shaft_diameter(gear.part)
    if shaft is not None and shaft <= largest:
        text = f"bore_diameter_mm {shaft / MM:.7g}: the shaft's outer diameter there"
        gear.part.say("inner_diameter", "derived", text)
        return shaft
    bore = _INTEGRAL * root
    why = "no bore and no shaft section" if shaft is None else "one piece with its shaft"
    text = f"bore_diameter_mm {bore / MM:.7g} = d_f / 2, within which nothing deflects: {why}"
    gear.part.say("inner_diameter", "defaulted", text)
    return bore


def _shaft_diameter(gear: Part) -> float | None:
    """Return the outer diameter of the shaft's section at the gear's middle, m."""
    shaft, u = gear.shaft, u_on_shaft(gear)
    if shaft is None or u is None:
        return None
    start = 0.0
    for section in shaft.children("shaft_section"):
        length = section.number("length", "length of the section") or 0.0
        start = section.number("u_coordinate_on_shaft", "begin of the section", start)
        if start <= u <= start + length:
            begin = section.number("outer_diameter_begin", "outer diameter of the section")
            end = section.number("outer_diameter_end", "outer diameter of the section")
            if begin is None or end is None:
                return begin if end is None else end
            share = 0.0 if length == 0.0 else (u - start) / length
            return begin + share * (end - begin)
        start += length
    return None


def elasticity(gear: Part) -> tuple[float, float]:
    """Return Young's modulus in Pa and Poisson's ratio: the gear's, its body's, its shaft's, else steel's."""
    shaft = gear.shaft
    owners = (gear, *gear.children("gear_body"), *(() if shaft is None else (shaft,)))
    for owner in owners:
        for material in owner.referenced:
            young = material.number("elastic_modulus", "youngs_modulus_gpa")
            if young is None:
                continue
            poisson = material.number("poisson_ratio", "poissons_ratio")
            if owner is not gear:
                gear.say("material", "derived", f"{material.name}, the material of {owner.name}")
            return young, STEEL[1] if poisson is None else poisson
    gear.say("material", "defaulted", f"steel, {STEEL[0] / GPA:g} GPa, {STEEL[1]:g}: the file names none")
    return STEEL


def blank_table(gear: ToothingData) -> Table:
    """Return rim and web of an external gear's body, nothing of a solid one."""
    for body in gear.part.children("gear_body") if gear.sign > 0 else ():
        rim = body.number("gear_body_rim_thickness", "blank.rim_thickness_mm")
        web = body.number("gear_body_web_thickness", "blank.web_thickness_mm")
        if rim and web:
            sizes = {"rim_thickness_mm": rim, "web_thickness_mm": web}
            return {"blank": {name: rounded(value / MM) for name, value in sizes.items()}}
        if body.attribute("body_contour_coordinate_u") is not None:
            body.say("body_contour_coordinate_u", "ignored", "a solid body: contours have no place in a case")
    return {}


def material_table(stiffness: tuple[float, float]) -> Table:
    """Return the table of a material of a case: Young's modulus in Pa and Poisson's ratio."""
    return {"youngs_modulus_gpa": rounded(stiffness[0] / GPA), "poissons_ratio": rounded(stiffness[1])}
