"""Teeth of a gear: module, angles, profile shift, tip and root diameters."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from fe_contact.flank.involute import involute_function
from fe_contact.geometry.toothing import FLANK, GENERATING, cutter_infeed
from lineofaction.gearbox.from_rexs.gear_unit import Part, rounded
from lineofaction.gearbox.from_rexs.meshing import LoadedFlank, Meshing
from lineofaction.gearbox.units import MM, UM, as_typed

_SHIFT = "addendum_modification_coefficient"

# Macro geometry of a gear as its file gives it, in SI (ISO 21771-1).


@dataclass(frozen=True)
class ToothingData:
    """Numbers of a gear's toothing; lengths in m, angles in rad, all but angles and shift positive."""

    loaded: LoadedFlank
    sign: int
    """1 of an external gear, -1 of a ring gear."""
    teeth: int
    normal_module: float
    pressure_angle: float
    helix_angle: float
    """> 0: right hand."""
    face_width: float
    profile_shift_coefficient: float | None
    """None where the file gives none."""

    @classmethod
    def of(cls, loaded: LoadedFlank) -> ToothingData:
        """Return the numbers of a gear."""
        gear = loaded.gear
        teeth = gear.required("number_of_teeth", "teeth")
        ring = gear.type == "ring_gear"
        if teeth != round(teeth) or teeth == 0.0 or (teeth < 0.0 and not ring):
            bound = f"a whole number {'other than' if ring else 'above'} 0"
            advice = "" if teeth > 0.0 else "A ring gear is a component of the type ring_gear."
            raise gear.refusal("number_of_teeth", teeth, bound, advice)
        return cls(
            loaded=loaded,
            sign=-1 if ring else 1,
            teeth=abs(round(teeth)),
            normal_module=gear.positive("normal_module", "normal_module_mm"),
            pressure_angle=_pressure_angle(loaded),
            helix_angle=_helix_angle(gear),
            face_width=gear.positive("face_width", "face_width_mm"),
            profile_shift_coefficient=_of_flanks(loaded, _SHIFT, "profile_shift_coefficient"),
        )

    @property
    def part(self) -> Part:
        """The gear."""
        return self.loaded.gear

    @cached_property
    def reference_diameter(self) -> float:
        """Reference diameter d = z m_n / cos(beta), m."""
        return self.teeth * self.normal_module / math.cos(self.helix_angle)

    @cached_property
    def transverse_pressure_angle(self) -> float:
        """alpha_t, rad."""
        return math.atan(math.tan(self.pressure_angle) / math.cos(self.helix_angle))


def _pressure_angle(loaded: LoadedFlank) -> float:
    """Return the normal pressure angle of the loaded flank, else of the other, else of the gear."""
    item, field = "normal_pressure_angle", "normal_pressure_angle_deg"
    value = _of_flanks(loaded, item, field)
    if value is None:
        value = loaded.gear.number(item, field)
        if value is not None:
            _say_difference(loaded, item, value)
    if value is None:
        loaded.gear.say(item, "defaulted", "20 deg (ISO 53)")
        return math.radians(20.0)
    return value


def _of_flanks(loaded: LoadedFlank, item: str, field: str) -> float | None:
    """Return a number of the loaded flank, else of the other."""
    value = next((value for flank in loaded.flanks if (value := flank.number(item, field)) is not None), None)
    if value is not None:
        _say_difference(loaded, item, value)
    return value


def _helix_angle(gear: Part) -> float:
    item = "helix_angle_reference_diameter"
    value = gear.number(item, "helix_angle_deg; > 0 is right hand", 0.0, "0: a spur gear")
    if not abs(value) < math.radians(80.0):
        raise gear.refusal(item, math.degrees(value), "-80 to 80 deg")
    return value + 0.0  # -0.0 becomes 0.0


def _say_difference(loaded: LoadedFlank, item: str, value: float) -> None:
    """State that a value of the unloaded flank is left aside where it differs."""
    other = loaded.other
    own = None if other is None else other.number(item, "as of the loaded flank")
    if other is not None and own is not None and own != value:
        other.say(item, "ignored", f"the case has the loaded {loaded.side} flank's")


# Profile shifts that a file leaves out, from the center distance and the mates (ISO 21771-1, clause 5.5).


@dataclass(frozen=True)
class ToothedPair:
    """What the file says of a stage's two gears; the second may be a ring gear."""

    meshing: Meshing
    pinion: ToothingData
    wheel: ToothingData
    center_distance: float
    """m."""
    axial_offset: float
    """Of the wheel's mid-face from the pinion's towards +z, m."""
    torques: tuple[float, ...]
    """On the driving gear, N m; of one sign."""

    @property
    def stage(self) -> Part:
        """The stage."""
        return self.meshing.stage

    @property
    def gears(self) -> tuple[ToothingData, ToothingData]:
        """Pinion and wheel."""
        return self.pinion, self.wheel

    @property
    def working_pressure_angle(self) -> float:
        """Transverse working pressure angle alpha_wt, rad."""
        pinion, wheel = self.pinion, self.wheel
        reference = abs(0.5 * (pinion.reference_diameter + wheel.sign * wheel.reference_diameter))
        cosine = reference * math.cos(pinion.transverse_pressure_angle) / self.center_distance
        if not 0.0 < cosine < 1.0:
            least = 1e3 * reference * math.cos(pinion.transverse_pressure_angle)
            value, bound = as_typed(self.center_distance, MM), f"above {least:.7g} mm"
            raise self.stage.refusal("center_distance", value, bound)
        return math.acos(cosine)

    @property
    def shift_sum(self) -> float:
        """x_1 + x_2 without backlash."""
        pinion, wheel = self.pinion, self.wheel
        involutes = involute_function(self.working_pressure_angle)
        involutes -= involute_function(pinion.transverse_pressure_angle)
        teeth = pinion.teeth + wheel.sign * wheel.teeth
        return involutes * teeth / (2.0 * math.tan(pinion.pressure_angle))


def derived_shifts(pairs: Sequence[ToothedPair]) -> dict[int, float]:
    """Return the profile shift coefficients by gear, missing ones derived mate by mate.

    A gear whose mates have none either stays without. Every pair's working pressure angle must exist.
    """
    gears = [gear for pair in pairs for gear in pair.gears]
    shifts = {
        gear.part.id: gear.profile_shift_coefficient
        for gear in gears
        if gear.profile_shift_coefficient is not None
    }
    while True:
        count = len(shifts)
        for pair in pairs:
            _derive(pair, shifts)
        if len(shifts) == count:
            return shifts


def _derive(pair: ToothedPair, shifts: dict[int, float]) -> None:
    """Add the shift of the gear of a pair that has none, if its mate has one."""
    for gear, mate in (pair.gears, pair.gears[::-1]):
        if gear.part.id not in shifts and mate.part.id in shifts:
            shift = pair.shift_sum - shifts[mate.part.id]
            shifts[gear.part.id] = 0.0 if abs(shift) < 1e-9 else shift
            total = "x_1 + x_2 = (z_1 + z_2) (inv alpha_wt - inv alpha_t) / (2 tan alpha_n)"
            gear.part.say(
                _SHIFT, "derived", f"x = {shifts[gear.part.id]:.6g} from {total} with {mate.part.name}"
            )


# Tooth thickness allowance of a gear, from the deviations of its span (ISO 21771-1, DIN 3967).


_UPPER, _LOWER = (f"{side}_backlash_allowance_referenced_to_span" for side in ("upper", "lower"))
_SERIES = "tooth_thickness_deviation_tolerance_series_din_3967_1978"


def _thickness_allowance(gear: ToothingData) -> float:
    """Return the normal tooth thickness removed at the reference circle in m: the mean of its limits.

    The span changes by the thickness times cos(alpha_n). A tolerance series (DIN 3967) without deviations is
    ignored, and so are deviations that thicken the teeth on average: the account says so.
    """
    part = gear.part
    if part.attribute(_SERIES) is not None:
        part.say(_SERIES, "ignored", "no backlash but that of the center distance, without deviations in µm")
    upper = part.number(_UPPER, "thickness_allowance_um")
    lower = part.number(_LOWER, "thickness_allowance_um")
    if upper is None or lower is None:
        return 0.0
    allowance = -0.5 * (upper + lower) / math.cos(gear.pressure_angle)
    if allowance < 0.0:
        for item in (_UPPER, _LOWER):
            part.say(item, "refused", "the mean deviation thickens the teeth: no allowance")
        return 0.0
    words = f"thickness_allowance_um {allowance / UM:.6g} = -(A_u + A_l) / (2 cos alpha_n)"
    for item in (_UPPER, _LOWER):
        part.say(item, "derived", words)
    return allowance


# Tip and root of a gear: from its diameters, its tool, or the basic rack (ISO 53, ISO 21771-1).


_ADDENDUM, _DEDENDUM, _RADIUS, _CUTTER_RADIUS = 1.0, 1.25, 0.38, 0.2
_ADDENDUM_BOUND, _DEDENDUM_BOUND = (0.1, 3.0), (0.1, 4.0)
_TOOLS = ("rack_shaped_tool", "cutter_wheel_tool", "profile_tool")


@dataclass(frozen=True)
class ToothDepth:
    """Tip and root of a gear in fields of the case: diameters in m, coefficients in normal modules."""

    tip_diameter: float
    tip_stated: bool
    """Whether the tip diameter is the file's."""
    dedendum_coefficient: float
    root_radius_coefficient: float
    thickness_allowance: float
    """Normal tooth thickness removed at the reference circle, m."""
    tooth_thinning: str
    """What removes it: the cutter, or grinding of the flanks."""
    cutter: Mapping[str, int | float] = field(default_factory=dict)
    """Fields of the pinion cutter of a ring gear; none where the file has none."""

    @classmethod
    def of(cls, gear: ToothingData, shift: float, tip_alteration: float) -> ToothDepth:
        """Return tip and root of a gear: x stated or derived, k <= 0 of a tip that the file leaves out."""
        tool, tip = _tool(gear.loaded), _stated_tip(gear, shift)
        allowance = _thickness_allowance(gear)
        root = _generated_root(gear, tool, shift, allowance)
        return cls(
            tip_diameter=_computed_tip(gear, shift, tip_alteration) if tip is None else tip,
            tip_stated=tip is not None,
            dedendum_coefficient=root.dedendum_coefficient,
            root_radius_coefficient=_root_radius(gear, tool),
            thickness_allowance=allowance,
            tooth_thinning=root.tooth_thinning,
            cutter=_cutter(tool, gear.sign),
        )

    def infeed(self, pressure_angle: float) -> float:
        """Return how much deeper in m the cutter stands for the allowance."""
        return (
            0.0 if self.tooth_thinning == FLANK else cutter_infeed(self.thickness_allowance, pressure_angle)
        )


def _stated_tip(gear: ToothingData, shift: float) -> float | None:
    """Return the tip diameter of the file in m, None if it gives none that a tip can have."""
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
    item, words = "addendum_coefficient_basic_profile", "h_aP of the tip diameter"
    stated = (flank.number(item, words) for flank in gear.loaded.flanks)
    addendum = next((value for value in stated if value is not None), _ADDENDUM)
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


@dataclass(frozen=True)
class _GeneratedRoot:
    """Depth h_fP of the root in normal modules, and what removes the thickness allowance."""

    dedendum_coefficient: float
    tooth_thinning: str = GENERATING


def _generated_root(gear: ToothingData, tool: Part | None, shift: float, allowance: float) -> _GeneratedRoot:
    """Return the root of a gear: of its root diameter, else of the tool's addendum, else h_fP 1.25."""
    value = gear.part.number("root_diameter", "dedendum_coefficient")
    if value:
        root = _root_at(gear, tool, abs(value), shift, allowance)
        if _DEDENDUM_BOUND[0] <= root.dedendum_coefficient <= _DEDENDUM_BOUND[1]:
            gear.part.say("root_diameter", "derived", _words_of_root(root, allowance))
            return root
        words = f"h_fP would be {root.dedendum_coefficient:.4g}, outside 0.1 to 4"
        gear.part.say("root_diameter", "refused", words)
    depth_of_tool = _addendum_of_tool(gear, tool, "dedendum_coefficient: the tool's addendum")
    if depth_of_tool is not None:
        return _GeneratedRoot(depth_of_tool)
    gear.part.say("dedendum_coefficient", "defaulted", f"{_DEDENDUM} (ISO 53): no root diameter, no tool")
    return _GeneratedRoot(_DEDENDUM)


_DIGIT = 1e-3 * MM
"""Last digit of root diameters, m: those of one tool at one place differ by half of it at most."""


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


def _words_of_root(root: _GeneratedRoot, allowance: float) -> str:
    """Return how h_fP follows from the root diameter."""
    words = f"dedendum_coefficient {root.dedendum_coefficient:.6g} = (d - d_f) / (2 m_n) + "
    if root.tooth_thinning == FLANK:
        return f"{words}x: the tool reaches it before the flanks are ground, tooth_thinning {FLANK}"
    if allowance:
        return f"{words}x - A_s / (2 m_n tan alpha_n), of a ring gear (d_f - d)"
    return f"{words}x, of a ring gear (d_f - d)"


def _addendum_of_tool(gear: ToothingData, tool: Part | None, words: str) -> float | None:
    """Return the tool's addendum in normal modules, None where the file has none."""
    items = ("addendum_coefficient_reference_profile", "addendum_reference_profile")
    return None if tool is None else _in_modules(gear, tool, items, (words, f"{words} / m_n"))


def _in_modules(
    gear: ToothingData, tool: Part, items: tuple[str, str], words: tuple[str, str]
) -> float | None:
    """Return a size of a tool in normal modules: by its factor, else by its length."""
    factor = tool.number(items[0], words[0])
    length = tool.number(items[1], words[1]) if factor is None else None
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


def _tool(loaded: LoadedFlank) -> Part | None:
    """Return the tool that makes the root: the first step of the loaded flank, else of the gear."""
    for part in (*loaded.flanks, loaded.gear):
        tools = (
            *part.related("manufacturing_step", "workpiece", "tool"),
            *part.related("ordered_reference", "origin", "referenced"),
            *part.referenced,
        )
        for tool in tools:
            if tool.type in _TOOLS:
                return tool
    return None
