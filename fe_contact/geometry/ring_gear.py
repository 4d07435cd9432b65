"""One internal involute gear (ISO 21771-1): data and closed forms."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from bounds import (
    LIMIT_SLACK,
    Declared,
    Kind,
    Quantity,
    Text,
    above,
    at_least,
    below,
    declared,
    described,
    integers,
    required,
    up_to,
)
from fe_contact.errors import InfeasibleGeometry, integer
from fe_contact.flank.involute import inverse_involute, involute_function
from fe_contact.geometry.basic_rack import ROOT_RADIUS, BasicRack
from fe_contact.geometry.fillet_curve import FilletCurve, FormPoint, turned_clockwise
from fe_contact.geometry.toothing import PROFILE_SHIFT, Toothing, counted
from fe_contact.types import FloatArray, Json

# Trimming interference: whether a pinion or a cutter can be moved radially into a ring gear.
#
# On the way out along the line of centers every tooth tip of the pinion must pass the ring's tip beside it.
# The clearance of the two edges across the line of centers is least where both move across at the same
# speed; the condition is JGMA's, in closed form, as e.g. in the gear handbooks of KHK and SDP/SI (eq. 5-9).


def radial_clearance(
    ratio: float, pressure_angles: tuple[float, float], working_pressure_angle: float
) -> float:
    """Angle in rad the pinion may turn towards the ring's flank before the tips touch on the way in.

    Parameters
    ----------
    ratio : float
        z_1 / z_2 < 1.
    pressure_angles : tuple of float
        Transverse pressure angles at the tip of the pinion and at the tip of the ring, rad.
    working_pressure_angle : float
        Transverse, rad.

    Returns
    -------
    float
        From flanks in contact; < 0 is trimming interference, -inf a pinion larger than the ring's bore, inf a
        ring whose tips do not reach over the pinion's.
    """
    first, second = pressure_angles
    cosines = math.cos(second) / math.cos(first)
    if cosines <= 1.0:
        return math.inf
    if ratio * cosines >= 1.0:
        return -math.inf
    pinion_edge = math.asin(math.sqrt((1.0 - cosines**-2) / (1.0 - ratio**2)))
    ring_edge = math.asin(math.sqrt((cosines**2 - 1.0) / (ratio**-2 - 1.0)))
    working = involute_function(working_pressure_angle)
    pinion_turn = pinion_edge + involute_function(first) - working
    return pinion_turn - (ring_edge + involute_function(second) - working) / ratio


# The pinion-type cutter (shaper cutter) that generates an internal gear.


@dataclass(frozen=True)
class _PinionCutter:
    """An external involute toothing with rounded tips, rolling inside the gear without backlash."""

    teeth: int
    """z_0."""
    base_radius: float
    base_half_angle: float
    """`base_radius`, `base_half_angle`: Base radius in m, and half the cutter tooth's angle there, rad."""
    tip_radius: float
    """d_a0 / 2 in m."""
    corner_radius: float
    """rho_a0: radius of the tip rounding in the transverse plane, m."""
    center_distance: float
    """Distance a_0 in m of the cutter's axis from the gear's at full depth."""
    ratio: float
    """z_0 / z: turn of the gear per turn of the cutter."""

    @property
    def working_pressure_angle(self) -> float:
        """Pressure angle of the generation alpha_w0, rad."""
        return math.acos(self.base_radius * (1.0 / self.ratio - 1.0) / self.center_distance)

    @property
    def pitch_radius(self) -> float:
        """Radius of the cutter's circle that rolls on the gear's, m."""
        return self.center_distance / (1.0 / self.ratio - 1.0)

    @property
    def common_tangent(self) -> float:
        """a_0 sin(alpha_w0) in m: the gear's roll length less the cutter's."""
        return self.center_distance * math.sin(self.working_pressure_angle)

    @property
    def corner_center_radius(self) -> float:
        """Distance of the rounding's center from the cutter's axis, m."""
        return self.tip_radius - self.corner_radius

    @property
    def corner_roll_length(self) -> float:
        """Roll length of the rounding's center, which lies on the flank's equidistant, m."""
        return math.sqrt(max(self.corner_center_radius**2 - self.base_radius**2, 0.0))

    @property
    def flank_end_roll_length(self) -> float:
        """Roll length at which the rounding touches the cutter's involute, m."""
        return self.corner_roll_length + self.corner_radius

    @property
    def first_tool_angle(self) -> float:
        """Tool angle at which the rounding leaves the involute, rad (see `_CutterTrochoid`)."""
        return math.atan2(self.corner_roll_length, self.base_radius)

    @property
    def corner_angle(self) -> float:
        """Angle from the cutter tooth's center line to the rounding's center, rad; < 0 does not fit."""
        foot = self.base_half_angle - self.flank_end_roll_length / self.base_radius
        return foot + self.first_tool_angle


# The tooth root fillet of an internal gear: envelope of a pinion cutter's tip rounding.


@dataclass(frozen=True)
class _CutterTrochoid(FilletCurve):
    """Fillet of the right flank of a ring gear, in the tooth frame."""

    cutter: _PinionCutter
    """The tool and its place in the gear."""
    half_pitch_angle: float
    """pi / z of the gear, rad: from its tooth's center line to that of the tooth space."""

    @property
    def root_angle(self) -> float:
        """Angle from the tooth's center line to the fillet's end on the root circle, rad."""
        return self.half_pitch_angle - self.cutter.corner_angle * self.cutter.ratio

    def _reach(self, tool_angle: FloatArray) -> FloatArray:
        """Projection of the cutter's pitch radius on the normal, m, >= 0."""
        across = self.cutter.corner_center_radius * np.cos(tool_angle)
        return np.asarray(np.sqrt(self.cutter.pitch_radius**2 - across**2), dtype=float)

    def _crossing(self, tool_angle: FloatArray) -> FloatArray:
        """Distance q along the normal from the rounding's center to the pitch circle, m."""
        return self._reach(tool_angle) - self.cutter.corner_center_radius * np.sin(tool_angle)

    def _crossing_angle(self, tool_angle: FloatArray) -> FloatArray:
        """Polar angle of that crossing on the cutter, from the rounding's center, rad."""
        crossing = self._crossing(tool_angle)
        along = self.cutter.corner_center_radius + crossing * np.sin(tool_angle)
        return np.asarray(np.arctan2(crossing * np.cos(tool_angle), along), dtype=float)

    def _to_tooth(self, x: FloatArray, y: FloatArray, tool_angle: FloatArray) -> FloatArray:
        """Vectors of the frame of centers at the generating position, in the tooth frame.

        The gear has turned with the cutter; the space's center line lies half a pitch from the tooth's, and
        the right flank of the tooth is the left one of the space: hence the mirror.
        """
        turned = (self.cutter.corner_angle + self._crossing_angle(tool_angle)) * self.cutter.ratio
        in_space = turned_clockwise(x, y, turned)
        angle = np.full(np.shape(tool_angle), self.half_pitch_angle)
        return turned_clockwise(-in_space[..., 0], in_space[..., 1], angle)

    def point(self, tool_angle: FloatArray) -> FloatArray:
        """Points (n, 2) in m."""
        angle, rounding = np.asarray(tool_angle, dtype=float), self.cutter.corner_radius
        along = self.cutter.corner_center_radius + rounding * np.sin(angle)
        tool = turned_clockwise(rounding * np.cos(angle), along, -self._crossing_angle(angle))
        return self._to_tooth(tool[..., 0], tool[..., 1] + self.cutter.center_distance, angle)

    def normal(self, tool_angle: FloatArray) -> FloatArray:
        """Outward unit normals (n, 2): out of the gear, into the tool."""
        angle = np.asarray(tool_angle, dtype=float)
        tool = turned_clockwise(-np.cos(angle), -np.sin(angle), -self._crossing_angle(angle))
        return self._to_tooth(tool[..., 0], tool[..., 1], angle)

    def radius(self, tool_angle: FloatArray) -> FloatArray:
        """Distance from the gear's center, m; grows monotonically with the tool angle."""
        return np.asarray(np.hypot(*np.moveaxis(self.point(tool_angle), -1, 0)), dtype=float)

    def polar_angle(self, tool_angle: FloatArray) -> FloatArray:
        """Angle from the tooth's center line, rad; positive on the right flank's side."""
        x, y = np.moveaxis(self.point(tool_angle), -1, 0)
        return np.asarray(np.arctan2(x, y), dtype=float)

    def speed(self, tool_angle: FloatArray) -> FloatArray:
        """Arc length per tool angle, m/rad.

        The tool's own arc plus the sliding between tool and gear: the distance from the pitch point times
        the rotation of the tool relative to the gear.
        """
        rounding, crossing = self.cutter.corner_radius, self._crossing(tool_angle)
        rotation = crossing / self._reach(tool_angle) * (1.0 - self.cutter.ratio)
        return np.asarray(rounding - (rounding - crossing) * rotation, dtype=float)


# Refusal of ring gears that cannot exist or cannot be cut, by the standard term for what is wrong.


_OTHER_CUTTER = "Choose another number of teeth or profile shift of the cutter."


def _refuse_shift_sum_of_cutter(gear: Toothing, teeth: int, profile_shift: float, involute: float) -> None:
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


def _refuse_narrow_rim(gear: Toothing) -> None:
    rim = 2.0 * gear.held_radius
    if rim <= 2.0 * gear.root_radius:
        bound = above(2.0 * gear.root_radius, "m", "the root diameter")
        raise InfeasibleGeometry("rim", "rim_diameter", rim, bound, "Raise the rim diameter.")


def _refuse_tip_diameter(gear: Toothing, cutter: _PinionCutter) -> None:
    """Refuse a tip circle beyond the involute at the fillet, or inside what the cutter's involute reaches."""
    if gear.tip_radius >= gear.form_radius:
        bound = below(2.0 * gear.form_radius, "m", "the form diameter", ", where the fillet begins")
        raise InfeasibleGeometry("tip diameter", "tip_diameter", 2.0 * gear.tip_radius, bound)
    smallest = math.hypot(gear.base_radius, cutter.common_tangent)
    if gear.tip_radius < smallest * (1.0 - LIMIT_SLACK):
        bound = at_least(2.0 * smallest, "m", note=", where the cutter's involute ends at its base circle")
        advice = f"Raise the tip diameter, or lower the addendum or the profile shift. {_OTHER_CUTTER}"
        name = "tip diameter" if gear.tip_radius < gear.base_radius else "interference"
        raise InfeasibleGeometry(name, "tip_diameter", 2.0 * gear.tip_radius, bound, advice)


def _refuse_rounding(gear: Toothing, cutter: _PinionCutter) -> None:
    """Refuse a rounding that does not fit on the cutter's tip."""
    if cutter.corner_angle < 0.0 or cutter.corner_center_radius < cutter.base_radius:
        bound = "smaller: the rounding does not fit between the two flanks of the cutter's tooth"
        advice = "Lower the root radius or the dedendum."
        raise InfeasibleGeometry(
            "root radius", "root_radius_coefficient", gear.root_radius_coefficient, bound, advice
        )


def _refuse_cut_tips(gear: Toothing, cutter: _PinionCutter) -> None:
    """Refuse a cutter that trims the tips it passes while it is fed in radially."""
    at_tips = (
        math.acos(cutter.base_radius / cutter.tip_radius),
        math.acos(min(1.0, gear.base_radius / gear.tip_radius)),
    )
    if radial_clearance(cutter.ratio, at_tips, cutter.working_pressure_angle) < 0.0:
        bound = "smaller: the cutter would trim the ring's tips while it is fed in"
        advice = "Lower the cutter's number of teeth, or raise the tip diameter."
        raise InfeasibleGeometry("trimming interference", "cutter_teeth", cutter.teeth, bound, advice)


def _refuse_pointed_tooth(gear: Toothing) -> None:
    if gear.tip_tooth_thickness <= 0.0:
        thickness = Quantity(gear.tip_tooth_thickness, "m", digits=3)
        bound = Text.of("larger: the transverse tip thickness is ", thickness)
        advice = "Raise the tip diameter, or lower the addendum."
        raise InfeasibleGeometry("pointed tooth", "tip_diameter", 2.0 * gear.tip_radius, bound, advice)


_RIM = "Outer diameter of the rim, which is held rigidly all round; above the root diameter"
_RADIUS = "Tip rounding rho_a0 of the cutter in the transverse plane, in normal modules"
_TEETH = "Teeth z_0 of the pinion cutter; fewer than the ring gear's"
_SHIFT = "Profile shift x_0 of the cutter in normal modules; large when new"


@described
@dataclass(frozen=True)
class RingGear(Toothing):
    """An internal cylindrical gear, generated by a pinion-type cutter.

    In ISO 21771-1 its teeth, diameters and center distance are negative. Here all of them are positive; the
    profile shift keeps the standard's sign: x > 0 thickens the teeth and moves them inwards, so x_1 + x_2 = 0
    keeps the center distance; d_f = d + 2 m_n (h_fP - x_E). It has the hand of its pinion. The tip diameter
    of the cutter follows from the root circle. Besides what is declared: `modification`, `material` and
    `pitch_deviation` (see `Toothing`). Raises `InputError`: a value out of its bounds; `InfeasibleGeometry`:
    no such gear: "rim", "tip diameter", "root radius", "profile shift sum", "interference" and "trimming
    interference" (with the cutter), "pointed tooth".
    """

    teeth: int = required(counted(12, 4000))
    rim_diameter: float = required(Declared(Kind.LENGTH, "m", up_to(500.0), _RIM, 0.212))
    _: KW_ONLY
    root_radius_coefficient: float = declared(0.2, replace(ROOT_RADIUS, description=_RADIUS, example=0.2))
    cutter_teeth: int = declared(25, Declared(Kind.COUNT, "", integers(6, 3999), _TEETH, 25))
    cutter_profile_shift_coefficient: float = declared(
        0.0, replace(PROFILE_SHIFT, description=_SHIFT, example=0.0)
    )

    sign: ClassVar[int] = -1

    def __post_init__(self) -> None:
        self._check_fields()
        integer("cutter_teeth", self.cutter_teeth, 6, self.teeth - 1, "Fewer teeth than the ring gear.")
        _ = self.basic_rack
        _refuse_narrow_rim(self)
        cutter = self.cutter
        _refuse_rounding(self, cutter)
        _refuse_tip_diameter(self, cutter)
        _refuse_cut_tips(self, cutter)
        _refuse_pointed_tooth(self)
        self._check_teeth()

    @cached_property
    def basic_rack(self) -> BasicRack:
        """The basic rack whose counterpart the cutter is; the root rounding is the cutter's, not its own."""
        return BasicRack(
            self.normal_module,
            self.normal_pressure_angle,
            self.addendum_coefficient,
            self.dedendum_coefficient,
            root_radius_coefficient=0.0,
        )

    @cached_property
    def cutter(self) -> _PinionCutter:
        """The generating pinion cutter at full depth."""
        pressure, ratio = self._generating_pressure_angle, self.cutter_teeth / self.teeth
        radius = ratio * self.base_radius
        distance = (self.base_radius - radius) / math.cos(pressure)
        shift = 2.0 * self.cutter_profile_shift_coefficient * math.tan(self.normal_pressure_angle)
        thickness = self.normal_module * (0.5 * math.pi + shift) + self.flank_grinding_allowance
        half_angle = thickness / (self.cutter_teeth * self.normal_module)
        return _PinionCutter(
            teeth=self.cutter_teeth,
            base_radius=radius,
            base_half_angle=half_angle + involute_function(self.transverse_pressure_angle),
            tip_radius=self.root_radius - distance,
            corner_radius=self.root_radius_coefficient * self.normal_module,
            center_distance=distance,
            ratio=ratio,
        )

    @cached_property
    def _generating_pressure_angle(self) -> float:
        """Working pressure angle with the cutter, from the profile shifts, rad."""
        cutter_shift = self.cutter_profile_shift_coefficient
        shifts = cutter_shift + self.generating_shift_coefficient
        involute = involute_function(self.transverse_pressure_angle)
        involute -= 2.0 * math.tan(self.normal_pressure_angle) * shifts / (self.teeth - self.cutter_teeth)
        _refuse_shift_sum_of_cutter(self, self.cutter_teeth, cutter_shift, involute)
        return inverse_involute(involute)

    @property
    def held_radius(self) -> float:
        """Outer radius of the rim, m."""
        return 0.5 * self.rim_diameter

    @cached_property
    def trochoid(self) -> _CutterTrochoid:
        """The fillet of the right flank."""
        return _CutterTrochoid(self.cutter, math.pi / self.teeth)

    @cached_property
    def form_point(self) -> FormPoint:
        """Where involute and fillet meet, always with a common tangent."""
        roll_length = self.cutter.common_tangent + self.cutter.flank_end_roll_length
        return FormPoint(roll_length, self.cutter.first_tool_angle, undercut=False)

    def macro_geometry(self) -> Json:
        """Return the shape of the unmodified gear as plain numbers (for content hashes)."""
        names = (
            "normal_module",
            "face_width",
            "rim_diameter",
            "normal_pressure_angle",
            "helix_angle",
            "dedendum_coefficient",
            "root_radius_coefficient",
            "cutter_profile_shift_coefficient",
        )
        counts = {"teeth": -int(self.teeth), "cutter_teeth": int(self.cutter_teeth)}
        return counts | {"tip_diameter": 2.0 * self.tip_radius} | self.generated_shape(names)
