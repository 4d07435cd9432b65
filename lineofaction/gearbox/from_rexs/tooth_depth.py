"""Tip and root of a gear: from its diameters, its tool, or the basic rack (ISO 53, ISO 21771-1)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from lineofaction.gearbox.from_rexs.flank_sides import LoadedFlank
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.toothing import ToothingData
from lineofaction.gearbox.units import MM

_ADDENDUM, _DEDENDUM, _RADIUS, _CUTTER_RADIUS = 1.0, 1.25, 0.38, 0.2
_ADDENDUM_BOUND, _DEDENDUM_BOUND = (0.1, 3.0), (0.1, 4.0)
_TOOLS = ("rack_shaped_tool", "cutter_wheel_tool", "profile_tool")


@dataclass(frozen=True)
class ToothDepth:
    """Tip and root of a gear in fields of the case: diameters in m, coefficients in normal modules.

    Attributes
    ----------
    tip_given : bool
        Whether the tip diameter is the file's.
    cutter_teeth, cutter_shift : int, float or None
        Of the pinion cutter of a ring gear; None where the file has none.
    """

    tip_diameter: float
    tip_given: bool
    dedendum_coefficient: float
    root_radius_coefficient: float
    cutter_teeth: int | None = None
    cutter_shift: float | None = None


def tooth_depth(
    unit: GearUnit, gear: ToothingData, loaded: LoadedFlank, shift: float, tip_alteration: float
) -> ToothDepth:
    """Return tip and root of a gear.

    Parameters
    ----------
    shift : float
        x, given or derived.
    tip_alteration : float
        k in normal modules of a tip that the file leaves out, <= 0.
    """
    tool = _tool(unit, gear.part, loaded)
    cutter = tool if tool is not None and tool.type == "cutter_wheel_tool" and gear.sign < 0 else None
    tip = _given_tip(gear, shift)
    return ToothDepth(
        tip_diameter=_computed_tip(gear, loaded, shift, tip_alteration) if tip is None else tip,
        tip_given=tip is not None,
        dedendum_coefficient=_dedendum(gear, tool, shift),
        root_radius_coefficient=_root_radius(gear, tool),
        cutter_teeth=None if cutter is None else _cutter_teeth(cutter),
        cutter_shift=None if cutter is None else _cutter_shift(cutter),
    )


def _given_tip(gear: ToothingData, shift: float) -> float | None:
    """Return the tip diameter of the file in m, None if it gives none that a tip can have."""
    value = gear.part.number("tip_diameter", "tip_diameter_mm")
    return None if value is None or not _is_tip(gear, abs(value), shift) else abs(value)


def _is_tip(gear: ToothingData, diameter: float, shift: float) -> bool:
    return _ADDENDUM_BOUND[0] <= _implied_addendum(gear, diameter, shift) <= _ADDENDUM_BOUND[1]


def _implied_addendum(gear: ToothingData, diameter: float, shift: float) -> float:
    """Return h_aP = (d_a - d) / (2 m_n) - x of a tip diameter, of a ring gear (d - d_a)."""
    return gear.sign * (diameter - gear.reference_diameter) / (2.0 * gear.normal_module) - shift


def _computed_tip(gear: ToothingData, loaded: LoadedFlank, shift: float, alteration: float) -> float:
    """Return d + 2 m_n (x + h_aP + k) in m, of a ring gear d - 2 m_n (x + h_aP)."""
    addendum = _addendum(loaded)
    height = shift + addendum + alteration
    computed = gear.reference_diameter + 2.0 * gear.sign * gear.normal_module * height
    formula = "d + 2 m_n (x + h_aP + k)" if gear.sign > 0 else "d - 2 m_n (x + h_aP)"
    words = f"{computed / MM:.7g} mm = {formula} with h_aP = {addendum:g}, k = {alteration:.4g}"
    value = gear.part.number("tip_diameter", "tip_diameter_mm")
    if value:
        implied = _implied_addendum(gear, abs(value), shift)
        words = f"{value / MM:.7g} mm is no tip diameter (h_aP would be {implied:.4g}); {words}"
    gear.part.say("tip_diameter", "defaulted", words)
    return computed


def _addendum(loaded: LoadedFlank) -> float:
    """Return the addendum coefficient of the flank's basic rack, 1 where the file gives none."""
    for flank in loaded.flanks:
        value = flank.number("addendum_coefficient_basic_profile", "h_aP of the tip diameter")
        if value is not None:
            return value
    return _ADDENDUM


def _dedendum(gear: ToothingData, tool: Part | None, shift: float) -> float:
    """Return h_fP: of the root diameter, else the tool's addendum, else 1.25."""
    value = gear.part.number("root_diameter", "dedendum_coefficient")
    if value:
        depth = gear.sign * (gear.reference_diameter - abs(value)) / (2.0 * gear.normal_module) + shift
        if _DEDENDUM_BOUND[0] <= depth <= _DEDENDUM_BOUND[1]:
            words = f"dedendum_coefficient {depth:.6g} = (d - d_f) / (2 m_n) + x, of a ring gear (d_f - d)"
            gear.part.say("root_diameter", "derived", words)
            return depth
        gear.part.say("root_diameter", "refused", f"h_fP would be {depth:.4g}, outside 0.1 to 4")
    item = "addendum_coefficient_reference_profile"
    depth_of_tool = None if tool is None else tool.number(item, "dedendum_coefficient: the tool's addendum")
    if depth_of_tool is None and tool is not None:
        length = tool.number("addendum_reference_profile", "dedendum_coefficient: the tool's addendum / m_n")
        depth_of_tool = None if length is None else length / gear.normal_module
    if depth_of_tool is not None:
        return depth_of_tool
    gear.part.say("dedendum_coefficient", "defaulted", f"{_DEDENDUM} (ISO 53): no root diameter, no tool")
    return _DEDENDUM


def _root_radius(gear: ToothingData, tool: Part | None) -> float:
    """Return the tip rounding of the tool in normal modules, at most the full fillet by default."""
    if tool is not None:
        words = "root_radius_coefficient: the tool's tip rounding"
        value = tool.number("tip_corner_radius_factor_reference_profile", words)
        if value is None:
            length = tool.number("tip_corner_radius_reference_profile", words)
            value = None if length is None else length / gear.normal_module
        if value is not None:
            _say_ignored(tool)
            return value
    default = _RADIUS if gear.sign > 0 else _CUTTER_RADIUS
    gear.part.say("root_radius_coefficient", "defaulted", f"{default}: no tool says its tip rounding")
    return default


def _say_ignored(tool: Part) -> None:
    """State what of a tool has no place in a case."""
    for item in ("protuberance_amount", "protuberance_amount_factor"):
        if tool.attribute(item) is not None:
            tool.say(item, "ignored", "the fillet is generated without protuberance")


def _cutter_teeth(cutter: Part) -> int | None:
    value = cutter.number("number_of_teeth", "cutter_teeth")
    return None if value is None else abs(round(value))


def _cutter_shift(cutter: Part) -> float | None:
    return cutter.number("addendum_modification_coefficient", "cutter_profile_shift_coefficient")


def _tool(unit: GearUnit, gear: Part, loaded: LoadedFlank) -> Part | None:
    """Return the tool that makes the root: the first step of the loaded flank, else of the gear."""
    workpieces = (*loaded.flanks, gear)
    for part in workpieces:
        tools = (
            *unit.related(part, "manufacturing_step", "workpiece", "tool"),
            *unit.related(part, "ordered_reference", "origin", "referenced"),
            *unit.related(part, "reference", "origin", "referenced"),
        )
        for tool in tools:
            if tool.type in _TOOLS:
                return tool
    return None


def tip_alteration(pair_shift_sum: float, reference: float, distance: float, module: float) -> float:
    """Return k = (a - a_d) / m_n - (x_1 + x_2) of an external pair, at most 0 (ISO 21771-1).

    Parameters
    ----------
    pair_shift_sum : float
        x_1 + x_2.
    reference, distance : float
        Reference and actual center distance, m.
    module : float
        Normal module, m.
    """
    alteration = (distance - reference) / module - pair_shift_sum
    return alteration if math.isfinite(alteration) and alteration < -1e-9 else 0.0
