"""The table of a case for one stage: gears with their bodies, loads and errors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from lineofaction.gearbox.convert.checked_case import check_plain_case
from lineofaction.gearbox.from_rexs.gear_body import (
    Table,
    blank_table,
    bore,
    elasticity,
    material_table,
    rim_diameter,
)
from lineofaction.gearbox.from_rexs.gear_unit import rounded
from lineofaction.gearbox.from_rexs.micro_geometry import micro_geometry
from lineofaction.gearbox.from_rexs.profile_shifts import ToothedPair
from lineofaction.gearbox.from_rexs.ring_tip import clearing_tip
from lineofaction.gearbox.from_rexs.tooth_depth import ToothDepth
from lineofaction.gearbox.from_rexs.toothing import ToothingData
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.units import DEGREE, MM, UM

LOAD_INTENSITIES = (5e6, 15e6, 30e6)
"""F_t / (b m_n) in Pa of the load levels of a stage without torques."""
_SAME_ANGLE = 1e-6  # difference within which angles are equal, rad
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
    if pair.meshing.internal and not depths[1].has_tip_diameter:
        depths[1] = clearing_tip(pair, depths, shifts)
    first, second = (
        _gear(gear, depth, shifts[gear.part.id]) for gear, depth in zip(pair.gears, depths, strict=True)
    )
    stiff = tuple(elasticity(gear.part) for gear in pair.gears)
    if stiff[0] != stiff[1]:
        second["material"] = material_table(stiff[1])
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
        "material": material_table(stiff[0]),
        "load": {"torque_n_m": _torques(pair)},
    }
    if abs(pair.axial_offset) > 1e-9:
        text = f"{pair.axial_offset / MM:.4g} mm between the mid-faces: the case puts them together"
        pair.stage.say("axial_offset", "ignored", text)
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
    gears = pair.gears
    pinion, wheel = gears
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
    pair: ToothedPair, labels: Sequence[str], bound: str, item: str = "", factor: int = 1
) -> BadInput:
    """Return the error of gears that do not mate: both values, and the mate's value as an assumption."""
    parts = [gear.part for gear in pair.gears]
    named = [f"{part.id} {part.name}: {label}" for part, label in zip(parts, labels, strict=True)]
    values = [None if (entry := part.attribute(item)) is None else entry.value for part in parts]
    mends = [
        f"--assume {part.id}.{item}={factor * mate:.9g}"
        for part, mate in zip(parts, values[::-1], strict=True)
        if isinstance(mate, (int, float))
    ]
    remedy = f"Open it with {' or '.join(mends)}." if mends else ""
    return pair.stage.refusal("gears", named, bound, remedy)


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
    seat_field, diameter = ("rim_diameter_mm", rim_diameter) if gear.sign < 0 else ("bore_diameter_mm", bore)
    return {
        "teeth": gear.teeth,
        "face_width_mm": rounded(gear.face_width / MM),
        "profile_shift_coefficient": rounded(shift),
        "tip_diameter_mm": rounded(depth.tip_diameter / MM),
        "dedendum_coefficient": rounded(depth.dedendum_coefficient),
        "root_radius_coefficient": rounded(depth.root_radius_coefficient),
        "thickness_allowance_um": rounded(depth.thickness_allowance / UM),
        "tooth_thinning": depth.tooth_thinning,
        seat_field: rounded(diameter(gear, root) / MM),
        **depth.cutter,
        **blank_table(gear),
    }


def _tip_alteration(gear: ToothingData, pairs: Sequence[ToothedPair], shifts: Mapping[int, float]) -> float:
    """Return the tip alteration coefficient of an external gear that suits all its external mates."""
    if gear.sign < 0:
        return 0.0
    meshing = (pair for pair in pairs if gear.part.id in {member.part.id for member in pair.gears})
    return min((_alteration(pair, shifts) for pair in meshing), default=0.0)


def _alteration(pair: ToothedPair, shifts: Mapping[int, float]) -> float:
    """Return k = (a - a_d) / m_n - (x_1 + x_2) of an external pair, at most 0 (ISO 21771-1); else 0."""
    first, second = (shifts.get(gear.part.id) for gear in pair.gears)
    if pair.wheel.sign < 0 or first is None or second is None:
        return 0.0
    reference = 0.5 * (pair.pinion.reference_diameter + pair.wheel.reference_diameter)
    alteration = (pair.center_distance - reference) / pair.pinion.normal_module - (first + second)
    return alteration if math.isfinite(alteration) and alteration < -1e-9 else 0.0


def _torques(pair: ToothedPair) -> list[float]:
    """Return the torques on the pinion in N m, increasing; those on a driving ring gear times z_1 / z_2."""
    pinion, wheel = pair.gears
    ratio = pinion.teeth / wheel.teeth if pair.meshing.wheel_drives else 1.0
    torques = sorted({rounded(abs(torque) * ratio) for torque in pair.torques if torque})
    if torques:
        return torques
    width = min(pinion.face_width, wheel.face_width)
    arm = 0.5 * pinion.reference_diameter * width * pinion.normal_module
    torques = [float(f"{intensity * arm:.3g}") for intensity in LOAD_INTENSITIES]
    intensities = ", ".join(f"{1e-6 * intensity:g}" for intensity in LOAD_INTENSITIES)
    text = f"{torques} N m on {pinion.part.name}: F_t / (b m_n) = {intensities} N/mm^2, for want of a torque"
    pair.stage.say("torque", "defaulted", text)
    return torques
