"""The table of a case for one stage: gears with their bodies, loads and errors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from fe_contact.errors import FeContactError
from fe_contact.geometry import Gear
from lineofaction.gearbox.convert.case import check_plain_case
from lineofaction.gearbox.from_rexs.gear_unit import Part, rounded
from lineofaction.gearbox.from_rexs.micro_geometry import micro_geometry
from lineofaction.gearbox.from_rexs.placement import u_on_shaft
from lineofaction.gearbox.from_rexs.toothing import ToothDepth, ToothedPair, ToothingData
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.units import DEGREE, GPA, MM, UM

# What carries the teeth: bore or rim, rim and web of the gear body, and the material.


RIM = 3.5
"""Normal modules: thinner rims weaken the tooth root, thicker have no influence (ISO 6336-3, clause 9)."""
_THINNEST = 1.0  # normal modules between bore and root circle; less is one piece with the shaft
_INTEGRAL = 0.5  # of the root diameter
STEEL = (210e9, 0.3)


def _rim_diameter(gear: ToothingData, root: float) -> float:
    for part in (gear.part, *gear.part.children("gear_body")):
        value = part.number("outer_diameter", "rim_diameter_mm")
        if value is not None and value > root:
            return value
    rim = root + 2.0 * RIM * gear.normal_module
    words = f"rim_diameter_mm {rim / MM:.7g} = d_f + 2 * {RIM} m_n: the file gives no rim"
    gear.part.say("outer_diameter", "defaulted", words)
    return rim


def _bore(gear: ToothingData, root: float) -> float:
    """Return the bore: the gear's or its body's own, else the shaft's outside, else half the root circle."""
    largest = root - 2.0 * _THINNEST * gear.normal_module
    for part in (gear.part, *gear.part.children("gear_body")):
        value = part.number("inner_diameter", "bore_diameter_mm")
        if value is not None and 0.0 < value < root:
            return value
    shaft = _shaft_diameter(gear.part)
    if shaft is not None and shaft <= largest:
        words = f"bore_diameter_mm {shaft / MM:.7g}: the shaft's outer diameter there"
        gear.part.say("inner_diameter", "derived", words)
        return shaft
    bore = _INTEGRAL * root
    why = "no bore and no shaft section" if shaft is None else "one piece with its shaft"
    words = f"bore_diameter_mm {bore / MM:.7g} = d_f / 2, within which nothing deflects: {why}"
    gear.part.say("inner_diameter", "defaulted", words)
    return bore


def _shaft_diameter(gear: Part) -> float | None:
    """Return the outer diameter of the shaft's section at the gear's middle, m."""
    shaft, place = gear.shaft, u_on_shaft(gear)
    if shaft is None or place is None:
        return None
    start = 0.0
    for section in shaft.children("shaft_section"):
        length = section.number("length", "length of the section") or 0.0
        start = section.number("u_coordinate_on_shaft", "begin of the section", start)
        if start <= place <= start + length:
            begin = section.number("outer_diameter_begin", "outer diameter of the section")
            end = section.number("outer_diameter_end", "outer diameter of the section")
            if begin is None or end is None:
                return begin if end is None else end
            return begin + (0.0 if length == 0.0 else (place - start) / length) * (end - begin)
        start += length
    return None


def _elasticity(gear: Part) -> tuple[float, float]:
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


# A ring gear's tip that the file leaves out, clear of the mate's fillet.


_STEP = 0.01 * MM  # tip diameters are rounded up to it


def _clearing_tip(pair: ToothedPair, depths: Sequence[ToothDepth], shifts: Mapping[int, float]) -> ToothDepth:
    """Return the ring gear's depth, of those of both, with a tip that stays on the involute of its mate.

    The tip meets the mate's form circle at the roll length l_F1 + a sin(alpha_wt) of the ring gear.
    """
    ring, depth = pair.wheel, depths[1]
    base = 0.5 * ring.reference_diameter * math.cos(ring.transverse_pressure_angle)
    tangent = pair.center_distance * math.sin(pair.working_pressure_angle)
    least = 2.0 * math.hypot(base, _form_roll_length(pair, depths[0], shifts) + tangent)
    if depth.tip_diameter > least:
        return depth
    tip = math.ceil(least / _STEP + 1e-3) * _STEP
    words = f"{tip / MM:.7g} mm, above {least / MM:.7g} mm = 2 sqrt(r_b2^2 + (l_F1 + a sin alpha_wt)^2),"
    words += f" where the tip meets the form circle of {pair.pinion.part.name}; d - 2 m_n (x + h_aP) would be"
    ring.part.say("tip_diameter", "defaulted", f"{words} {depth.tip_diameter / MM:.7g} mm")
    return replace(depth, tip_diameter=tip)


def _form_roll_length(pair: ToothedPair, depth: ToothDepth, shifts: Mapping[int, float]) -> float:
    gear, shift = pair.pinion, shifts[pair.pinion.part.id]
    try:
        return Gear(
            gear.teeth,
            gear.normal_module,
            gear.face_width,
            0.1 * gear.reference_diameter,  # any bore: the flank does not depend on it
            normal_pressure_angle=gear.pressure_angle,
            helix_angle=gear.helix_angle,
            profile_shift_coefficient=shift,
            dedendum_coefficient=depth.dedendum_coefficient,
            root_radius_coefficient=depth.root_radius_coefficient,
            tip_diameter=depth.tip_diameter,
            thickness_allowance=depth.thickness_allowance,
            tooth_thinning=depth.tooth_thinning,
        ).form_roll_length
    except FeContactError as error:
        raise BadInput.of(gear.part.place, gear.part.name, f"a gear that exists: {error}") from None


Table = dict[str, Any]

LOAD_INTENSITIES = (5e6, 15e6, 30e6)
"""F_t / (b m_n) in Pa of the load levels of a stage without torques."""
_SAME_ANGLE = 1e-6  # rad
_HELIX = "helix_angle_reference_diameter"


def case_of(pair: ToothedPair, pairs: Sequence[ToothedPair], shifts: Mapping[int, float]) -> Case:
    """Return the case of a pair that can be computed.

    Parameters
    ----------
    pairs : sequence of ToothedPair
        All of the unit; a gear's tip clears all its mates.
    shifts : mapping of int to float
        Profile shift coefficients by gear.
    """
    _refuse_strangers(pair)
    depths = [_depth(gear, pairs, shifts) for gear in pair.gears]
    if pair.meshing.internal and not depths[1].tip_stated:
        depths[1] = _clearing_tip(pair, depths, shifts)
    first, second = (
        _gear(gear, depth, shifts[gear.part.id]) for gear, depth in zip(pair.gears, depths, strict=True)
    )
    stiff = tuple(_elasticity(gear.part) for gear in pair.gears)
    if stiff[0] != stiff[1]:
        second["material"] = _material(stiff[1])
    pinion = pair.pinion
    if pair.meshing.internal:
        second["internal"] = True
    table = {
        "pair": {
            "normal_module_mm": rounded(pinion.normal_module / MM),
            "normal_pressure_angle_deg": rounded(pinion.pressure_angle / DEGREE),
            "helix_angle_deg": rounded(pinion.helix_angle / DEGREE),
            "center_distance_mm": rounded(pair.center_distance / MM),
            "pinion": first,
            "wheel": second,
        },
        "material": _material(stiff[0]),
        "load": {"torque_n_m": _torques(pair)},
    }
    if abs(pair.axial_offset) > 1e-9:
        words = f"{pair.axial_offset / MM:.4g} mm between the mid-faces: the case puts them together"
        pair.stage.say("axial_offset", "ignored", words)
    plain = check_plain_case(validated(Case, table))
    first.update(micro_geometry(plain.pinion, pinion.loaded))
    second.update(micro_geometry(plain.wheel, pair.wheel.loaded))
    case = validated(Case, table)
    check_plain_case(case)
    return case


def _refuse_strangers(pair: ToothedPair) -> None:
    """Refuse gears of different module or pressure angle, or of helix angles that do not mate.

    Hands must be opposite, but the sign of a ring gear's helix angle depends on the writer's sign of its
    teeth: its size must fit.
    """
    gears = pinion, wheel = pair.gears
    first, second = pinion.helix_angle, wheel.helix_angle
    modules = [f"module {gear.normal_module / MM:.9g} mm" for gear in gears]
    angles = [f"pressure angle {gear.pressure_angle / DEGREE:.9g} deg" for gear in gears]
    hands = [
        f"{'right' if gear.helix_angle > 0.0 else 'left'} hand, {abs(gear.helix_angle) / DEGREE:.9g} deg"
        for gear in gears
    ]
    if not math.isclose(pinion.normal_module, wheel.normal_module, rel_tol=1e-9):
        raise _strangers(pair, modules, "of one normal module", "normal_module")
    if abs(pinion.pressure_angle - wheel.pressure_angle) >= _SAME_ANGLE:
        raise _strangers(pair, angles, "of one normal pressure angle")
    if wheel.sign > 0 and abs(first + second) >= _SAME_ANGLE:
        raise _strangers(pair, hands, "of helix angles of one size and of opposite hands", _HELIX, -1)
    if abs(abs(first) - abs(second)) >= _SAME_ANGLE:
        raise _strangers(pair, hands, "of helix angles of one size", _HELIX)
    if wheel.sign < 0 and wheel.helix_angle:
        wheel.part.say(_HELIX, "derived", "the hand is that of its mate")


def _strangers(
    pair: ToothedPair, facts: Sequence[str], bound: str, item: str = "", factor: int = 1
) -> BadInput:
    """Return the error of gears that do not mate: what each is, and its mate's value as an assumption."""
    parts = [gear.part for gear in pair.gears]
    named = [f"{part.id} {part.name}: {fact}" for part, fact in zip(parts, facts, strict=True)]
    stated = [None if (entry := part.attribute(item)) is None else entry.value for part in parts]
    mends = [
        f"--assume {part.id}.{item}={factor * mate:.9g}"
        for part, mate in zip(parts, stated[::-1], strict=True)
        if isinstance(mate, (int, float))
    ]
    advice = f"Open it with {' or '.join(mends)}." if mends else ""
    return pair.stage.refusal("gears", named, bound, advice)


def _depth(gear: ToothingData, pairs: Sequence[ToothedPair], shifts: Mapping[int, float]) -> ToothDepth:
    """Return tip and root of a gear; raises `BadInput` without a profile shift."""
    shift = shifts.get(gear.part.id)
    if shift is None:
        bound = "given for this gear or for its mate"
        raise gear.part.refusal("addendum_modification_coefficient", None, bound)
    return ToothDepth.of(gear, shift, _tip_alteration(gear, pairs, shifts))


def _gear(gear: ToothingData, depth: ToothDepth, shift: float) -> Table:
    # d_f = d - 2 m_n (h_fP - x_E), of a ring gear d + 2 m_n (h_fP - x_E)
    height = gear.normal_module * (depth.dedendum_coefficient - shift) + depth.infeed(gear.pressure_angle)
    root = gear.reference_diameter - 2.0 * gear.sign * height
    held, diameter = ("rim_diameter_mm", _rim_diameter) if gear.sign < 0 else ("bore_diameter_mm", _bore)
    return {
        "teeth": gear.teeth,
        "face_width_mm": rounded(gear.face_width / MM),
        "profile_shift_coefficient": rounded(shift),
        "tip_diameter_mm": rounded(depth.tip_diameter / MM),
        "dedendum_coefficient": rounded(depth.dedendum_coefficient),
        "root_radius_coefficient": rounded(depth.root_radius_coefficient),
        "thickness_allowance_um": rounded(depth.thickness_allowance / UM),
        "tooth_thinning": depth.tooth_thinning,
        held: rounded(diameter(gear, root) / MM),
        **depth.cutter,
        **_blank(gear),
    }


def _tip_alteration(gear: ToothingData, pairs: Sequence[ToothedPair], shifts: Mapping[int, float]) -> float:
    """Return the tip alteration coefficient of an external gear that suits all its external mates."""
    if gear.sign < 0:
        return 0.0
    own = (pair for pair in pairs if gear.part.id in {each.part.id for each in pair.gears})
    return min((_alteration(pair, shifts) for pair in own), default=0.0)


def _alteration(pair: ToothedPair, shifts: Mapping[int, float]) -> float:
    """Return k = (a - a_d) / m_n - (x_1 + x_2) of an external pair, at most 0 (ISO 21771-1); else 0."""
    first, second = (shifts.get(gear.part.id) for gear in pair.gears)
    if pair.wheel.sign < 0 or first is None or second is None:
        return 0.0
    reference = 0.5 * (pair.pinion.reference_diameter + pair.wheel.reference_diameter)
    alteration = (pair.center_distance - reference) / pair.pinion.normal_module - (first + second)
    return alteration if math.isfinite(alteration) and alteration < -1e-9 else 0.0


def _blank(gear: ToothingData) -> Table:
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


def _material(stiffness: tuple[float, float]) -> Table:
    return {"youngs_modulus_gpa": rounded(stiffness[0] / GPA), "poissons_ratio": rounded(stiffness[1])}


def _torques(pair: ToothedPair) -> list[float]:
    """Return the torques on the pinion in N m, increasing; of a driving ring gear z_1 / z_2 of its own."""
    pinion, wheel = pair.gears
    ratio = pinion.teeth / wheel.teeth if pair.meshing.wheel_drives else 1.0
    torques = sorted({rounded(abs(torque) * ratio) for torque in pair.torques if torque})
    if torques:
        return torques
    width = min(pinion.face_width, wheel.face_width)
    arm = 0.5 * pinion.reference_diameter * width * pinion.normal_module
    torques = [float(f"{intensity * arm:.3g}") for intensity in LOAD_INTENSITIES]
    intensities = ", ".join(f"{1e-6 * intensity:g}" for intensity in LOAD_INTENSITIES)
    words = f"{torques} N m on {pinion.part.name}: F_t / (b m_n) = {intensities} N/mm^2, for want of a torque"
    pair.stage.say("torque", "defaulted", words)
    return torques
