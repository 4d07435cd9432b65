"""Tip and root of a gear: from its diameters, its tool, or the basic rack (ISO 53, ISO 21771-1).

Symbols: d reference, d_a tip and d_f root diameter, m_n normal module, x profile shift and k tip alteration
coefficient, h_aP addendum and h_fP dedendum of the basic rack in normal modules, x_E the x at which the gear
is cut, A_s the thickness allowance. The sign of a gear is -1 for a ring gear.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from fe_contact.geometry.toothing import FLANK, GENERATING, cutter_infeed
from lineofaction.gearbox.from_rexs.gear_unit import Part, rounded
from lineofaction.gearbox.from_rexs.loaded_flank import LoadedFlank
from lineofaction.gearbox.from_rexs.tooth_thickness import thickness_allowance
from lineofaction.gearbox.from_rexs.toothing import ToothingData
from lineofaction.gearbox.units import MM

_ADDENDUM, _DEDENDUM, _RADIUS = 1.0, 1.25, 0.38
"""h_aP, h_fP and root radius, normal modules, where the file states none: basic rack A of ISO 53."""

_CUTTER_RADIUS = 0.2
"""Tip rounding of a ring gear's pinion cutter, normal modules, where the file states none."""

_ADDENDUM_BOUND, _DEDENDUM_BOUND = (0.1, 3.0), (0.1, 4.0)
"""h_aP and h_fP of real gears: diameters that imply others are errors of the file."""

_TOOLS = ("rack_shaped_tool", "cutter_wheel_tool", "profile_tool")

_DIGIT = 1e-3 * MM
"""Last digit of root diameters, m: root diameters by one tool at one place differ by half of it at most."""


@dataclass(frozen=True)
class ToothDepth:
    """Tip and root of a gear in fields of the case: diameters in m, coefficients in normal modules."""

    tip_diameter: float
    has_tip_diameter: bool
    """Whether the tip diameter is the file's."""
    dedendum_coefficient: float
    root_radius_coefficient: float
    thickness_allowance: float
    """Normal tooth thickness removed at the reference circle, m."""
    tooth_thinning: str
    """Way in which the allowance is removed: by the cutter, or by grinding of the flanks."""
    cutter: Mapping[str, int | float] = field(default_factory=dict)
    """Fields of the pinion cutter of a ring gear; none where the file has none."""

    @classmethod
    def of(cls, gear: ToothingData, shift: float, tip_alteration: float) -> ToothDepth:
        """Return tip and root of a gear.

        `shift`: x, stated by the file or derived. `tip_alteration`: k, at most 0, of a tip diameter that the
        file does not state.
        """
        tool, tip = _tool(gear.loaded), _tip_of_file(gear, shift)
        allowance = thickness_allowance(gear)
        root = _generated_root(gear, tool, shift, allowance)
        return cls(
            tip_diameter=_computed_tip(gear, shift, tip_alteration) if tip is None else tip,
            has_tip_diameter=tip is not None,
            dedendum_coefficient=root.dedendum_coefficient,
            root_radius_coefficient=_root_radius(gear, tool),
            thickness_allowance=allowance,
            tooth_thinning=root.tooth_thinning,
            cutter=_cutter(tool, gear.sign),
        )

    def infeed(self, pressure_angle: float) -> float:
        """Return the infeed of the cutter for the allowance, m."""
        return (
            0.0 if self.tooth_thinning == FLANK else cutter_infeed(self.thickness_allowance, pressure_angle)
        )


def _tip_of_file(gear: ToothingData, shift: float) -> float | None:
    """Return the tip diameter of the file in m, None if it states none or one that no tip can have."""
    value = gear.part.number("tip_diameter", "tip_diameter_mm")
    if value is None:
        return None
    lowest, highest = _ADDENDUM_BOUND
    return abs(value) if lowest <= _implied_addendum(gear, abs(value), shift) <= highest else None


def _implied_addendum(gear: ToothingData, diameter: float, shift: float) -> float:
    """Return h_aP = (d_a - d) / (2 m_n) - x of a tip diameter, of a ring gear (d - d_a)."""
    return gear.sign * (diameter - gear.reference_diameter) / (2.0 * gear.normal_module) - shift


def _computed_tip(gear: ToothingData, shift: float, alteration: float) -> float:
    """Return d + 2 m_n (x + h_aP + k) in m, of a ring gear d - 2 m_n (x + h_aP)."""
    item, text = "addendum_coefficient_basic_profile", "h_aP of the tip diameter"
    depths = (flank.number(item, text) for flank in gear.loaded.flanks)
    addendum = next((value for value in depths if value is not None), _ADDENDUM)
    height = shift + addendum + alteration
    computed = gear.reference_diameter + 2.0 * gear.sign * gear.normal_module * height
    formula = "d + 2 m_n (x + h_aP + k)" if gear.sign > 0 else "d - 2 m_n (x + h_aP)"
    text = f"{computed / MM:.7g} mm = {formula} with h_aP = {addendum:g}, k = {alteration:.4g}"
    value = gear.part.number("tip_diameter", "tip_diameter_mm")
    if value:
        implied = _implied_addendum(gear, abs(value), shift)
        text = f"{value / MM:.7g} mm is no tip diameter (h_aP would be {implied:.4g}); {text}"
    gear.part.say("tip_diameter", "defaulted", text)
    return computed


@dataclass(frozen=True)
class _GeneratedRoot:
    """Depth h_fP of the root in normal modules, and the tool that removes the thickness allowance."""

    dedendum_coefficient: float
    tooth_thinning: str = GENERATING


def _generated_root(gear: ToothingData, tool: Part | None, shift: float, allowance: float) -> _GeneratedRoot:
    """Return the root of a gear: of its root diameter, else of the tool's addendum, else h_fP 1.25."""
    value = gear.part.number("root_diameter", "dedendum_coefficient")
    if value:
        root = _root_at(gear, tool, abs(value), shift, allowance)
        if _DEDENDUM_BOUND[0] <= root.dedendum_coefficient <= _DEDENDUM_BOUND[1]:
            gear.part.say("root_diameter", "derived", _text_of_root(root, allowance))
            return root
        text = f"h_fP would be {root.dedendum_coefficient:.4g}, outside 0.1 to 4"
        gear.part.say("root_diameter", "refused", text)
    depth_of_tool = _addendum_of_tool(gear, tool, "dedendum_coefficient: the tool's addendum")
    if depth_of_tool is not None:
        return _GeneratedRoot(depth_of_tool)
    gear.part.say("dedendum_coefficient", "defaulted", f"{_DEDENDUM} (ISO 53): no root diameter, no tool")
    return _GeneratedRoot(_DEDENDUM)


def _root_at(
    gear: ToothingData, tool: Part | None, diameter: float, shift: float, allowance: float
) -> _GeneratedRoot:
    """Return the root at a root diameter in m: h_fP = (d - d_f) / (2 m_n) + x_E, of a ring gear (d_f - d).

    The cutter removes the allowance, unless the tool's addendum gives this diameter without it.
    """
    nominal = gear.sign * (gear.reference_diameter - diameter) / (2.0 * gear.normal_module) + shift
    infeed = cutter_infeed(allowance, gear.pressure_angle) / gear.normal_module
    digit = 0.5 * _DIGIT / gear.normal_module
    if infeed > digit:
        of_tool = _addendum_of_tool(gear, tool, "compared with the root diameter")
        if of_tool is not None and abs(nominal - of_tool) <= digit:
            return _GeneratedRoot(nominal, FLANK)
    return _GeneratedRoot(nominal - infeed)


def _text_of_root(root: _GeneratedRoot, allowance: float) -> str:
    """Return the formula by which h_fP follows from the root diameter, as text."""
    text = f"dedendum_coefficient {root.dedendum_coefficient:.6g} = (d - d_f) / (2 m_n) + "
    if root.tooth_thinning == FLANK:
        return f"{text}x: the tool reaches it before the flanks are ground, tooth_thinning {FLANK}"
    if allowance:
        return f"{text}x - A_s / (2 m_n tan alpha_n), of a ring gear (d_f - d)"
    return f"{text}x, of a ring gear (d_f - d)"


def _addendum_of_tool(gear: ToothingData, tool: Part | None, meaning: str) -> float | None:
    """Return the tool's addendum in normal modules, None where the file has none."""
    items = ("addendum_coefficient_reference_profile", "addendum_reference_profile")
    return None if tool is None else _in_modules(gear, tool, items, (meaning, f"{meaning} / m_n"))


def _in_modules(
    gear: ToothingData, tool: Part, items: tuple[str, str], meanings: tuple[str, str]
) -> float | None:
    """Return a size of a tool in normal modules: by its factor, else by its length."""
    factor = tool.number(items[0], meanings[0])
    length = tool.number(items[1], meanings[1]) if factor is None else None
    return factor if length is None else length / gear.normal_module


def _root_radius(gear: ToothingData, tool: Part | None) -> float:
    """Return the tip rounding of the tool in normal modules, at most the full fillet by default."""
    if tool is not None:
        items = ("tip_corner_radius_factor_reference_profile", "tip_corner_radius_reference_profile")
        value = _in_modules(gear, tool, items, ("root_radius_coefficient: the tool's tip rounding",) * 2)
        if value is not None:
            for item in ("protuberance_amount", "protuberance_amount_factor"):
                if tool.attribute(item) is not None:
                    tool.say(item, "ignored", "the fillet is generated without protuberance")
            return value
    default = _RADIUS if gear.sign > 0 else _CUTTER_RADIUS
    gear.part.say("root_radius_coefficient", "defaulted", f"{default}: no tool says its tip rounding")
    return default


def _cutter(tool: Part | None, sign: int) -> Mapping[str, int | float]:
    """Return the fields of a ring gear's pinion cutter that the file has."""
    if tool is None or tool.type != "cutter_wheel_tool" or sign > 0:
        return {}
    teeth = tool.number("number_of_teeth", "cutter_teeth")
    shift = tool.number("addendum_modification_coefficient", "cutter_profile_shift_coefficient")
    fields: dict[str, int | float] = {} if teeth is None else {"cutter_teeth": abs(round(teeth))}
    return fields if shift is None else fields | {"cutter_profile_shift_coefficient": rounded(shift)}


def _tool(flank: LoadedFlank) -> Part | None:
    """Return the tool that makes the root: the first step of the loaded flank, else of the gear."""
    for part in (*flank.flanks, flank.gear):
        tools = (
            *part.related("manufacturing_step", "workpiece", "tool"),
            *part.related("ordered_reference", "origin", "referenced"),
            *part.referenced,
        )
        for tool in tools:
            if tool.type in _TOOLS:
                return tool
    return None
