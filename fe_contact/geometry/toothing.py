"""One signed set of closed forms for external and internal involute toothings (ISO 21771-1).

The standard counts the teeth of an internal gear negative, so that one formula serves both kinds. Here all
numbers and radii are positive and `sign` carries the standard's sign.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from bounds import Declared, Kind, SiNote, between, declared, described, one_of, required, up_to
from fe_contact.body import CLAMPED, BoreSeat
from fe_contact.errors import declared_fields, within
from fe_contact.flank.modification import UNMODIFIED, FlankModification
from fe_contact.geometry.basic_rack import ADDENDUM, DEDENDUM, NORMAL_MODULE, PRESSURE_ANGLE, ROOT_RADIUS
from fe_contact.geometry.pitch_deviation import NO_PITCH_DEVIATION, PitchDeviation, counted
from fe_contact.geometry.tooth_deviations import NO_RUN_OUT, RunOut, Wave, deviations_period
from fe_contact.geometry.tooth_flank import MAX_TEETH, ToothFlank, check_flanks, turned_back
from fe_contact.involute import involute_function, roll_length_at_radius
from fe_contact.material import STEEL, Material

if TYPE_CHECKING:
    from fe_contact.body import Web
    from fe_contact.geometry.fillet_curve import FilletCurve
    from fe_contact.geometry.form_point import FormPoint
    from fe_contact.types import FloatArray, Json


_FACE = Declared(Kind.LENGTH, "m", between(1e-6, 50.0), "Face width b", 0.025, with_unit=True)
_LIMIT = math.radians(50.0)
_HELIX = Declared(
    Kind.ANGLE,
    "rad",
    between(-_LIMIT, _LIMIT),
    "Helix angle at the reference circle; > 0: right hand. External gears mesh with opposite hands",
    0.0,
)
PROFILE_SHIFT = Declared(Kind.RATIO, "", between(-3.0, 3.0), "Profile shift x in normal modules", 0.2)
_TIP = Declared(
    Kind.LENGTH,
    "m",
    up_to(500.0),
    "Tip diameter; left out: d + 2 m_n (h_aP + x), of a ring gear d - 2 m_n (h_aP + x)",
    0.088,
)
_ALLOWANCE = Declared(
    Kind.LENGTH,
    "m",
    between(0.0, 5.0),
    "Normal tooth thickness removed at the reference circle, which is backlash; up to half a module",
    5e-5,
    written="µm",
)
GENERATING, FLANK = "generating", "flank"
_THINNING = Declared(
    Kind.CHOICE,
    "",
    one_of((GENERATING, FLANK)),
    "What removes the thickness allowance A; generating: the cutter, which stands deeper by"
    " A / (2 tan alpha_n), and the root with it (x_E of ISO 21771); flank: grinding of the flanks, which"
    " leaves the root circle",
    FLANK,
    omit_default=True,
)

_OF_AXIS = "Axis of the teeth off the axis of rotation; left out: they are one"
_RUN_OUT = Declared(Kind.PART, "", None, _OF_AXIS, part=RunOut, omit_default=True)
_OF_FLANKS = "Waves on all loaded flanks, left by machining"
_WAVES = Declared(Kind.PARTS, "", None, _OF_FLANKS, part=Wave, omit_default=True)
_OF_TEETH = "Deviations of the loaded flanks of single teeth; teeth without an entry are as designed"
_TOOTH_FLANKS = Declared(
    Kind.PARTS, "", None, _OF_TEETH, part=ToothFlank, omit_default=True, maximum=MAX_TEETH
)

MATING = ("normal_module", "normal_pressure_angle", "helix_angle")
"""Fields in which mating gears agree, except for the hand of the helix of external gears."""


def cutter_infeed(thickness_allowance: float, normal_pressure_angle: float) -> float:
    """Return by how much deeper, m, a cutter stands that removes a normal tooth thickness in m."""
    return 0.5 * thickness_allowance / math.tan(normal_pressure_angle)


@described
@dataclass(frozen=True)
class Toothing:
    """Data and closed forms of a cylindrical involute gear; use `Gear` or `RingGear`.

    All numbers are positive for both kinds. The cutter removes the thickness allowance, and stands deeper for
    it (`generating_shift_coefficient`); the tip circle stays where it is. `modification`: departures of the
    flanks from the involute helicoid; `material`: elasticity; `pitch_deviation`: of the loaded flank of every
    tooth.
    """

    teeth: int = required(counted(4, 4000))
    normal_module: float = required(NORMAL_MODULE)
    face_width: float = required(_FACE)
    _: KW_ONLY
    normal_pressure_angle: float = declared(math.radians(20.0), PRESSURE_ANGLE)
    helix_angle: float = declared(0.0, _HELIX)
    profile_shift_coefficient: float = declared(0.0, PROFILE_SHIFT)
    addendum_coefficient: float = declared(1.0, ADDENDUM)
    dedendum_coefficient: float = declared(1.25, DEDENDUM)
    root_radius_coefficient: float = declared(0.38, ROOT_RADIUS)
    tip_diameter: float | None = declared(None, _TIP)
    thickness_allowance: float = declared(0.0, _ALLOWANCE)
    tooth_thinning: str = declared(GENERATING, _THINNING)
    modification: FlankModification = UNMODIFIED
    material: Material = STEEL
    pitch_deviation: PitchDeviation = NO_PITCH_DEVIATION
    run_out: RunOut = declared(NO_RUN_OUT, _RUN_OUT)
    waves: tuple[Wave, ...] = declared((), _WAVES)
    tooth_flanks: tuple[ToothFlank, ...] = declared((), _TOOTH_FLANKS)

    sign: ClassVar[int] = 1  # of the tooth number in ISO 21771-1: +1 external, -1 internal

    if TYPE_CHECKING:  # properties that `Gear` and `RingGear` define

        @property
        def seat_radius(self) -> float:
            """Radius in m of the circle that the gear is held by: its bore, the outside of a ring's rim."""

        def macro_geometry(self) -> Json:
            """All that decides the shape of the unmodified gear, as plain numbers (for content hashes)."""

        @property
        def trochoid(self) -> FilletCurve:
            """The fillet of the right flank."""

        @property
        def form_point(self) -> FormPoint:
            """Point at which involute and fillet meet."""

    def _check_fields(self) -> None:
        """Check all numbers one by one, and the allowance against the tooth it is taken from."""
        declared_fields(self)
        half, note = 0.5 * self.normal_module, SiNote("In m: 0.1 mm is 1e-4.")
        within("thickness_allowance", self.thickness_allowance, 0.0, half, note)

    def _check_teeth(self) -> None:
        """Check modifications and deviations against the teeth that they are of."""
        self.modification.check_fits(self)
        self.pitch_deviation.check_fits(self.teeth)
        check_flanks(self, self.tooth_flanks, self.teeth)

    @cached_property
    def transverse_module(self) -> float:
        """m_t = m_n / cos(beta), m."""
        return self.normal_module / math.cos(self.helix_angle)

    @cached_property
    def transverse_pressure_angle(self) -> float:
        """alpha_t, rad."""
        return math.atan(math.tan(self.normal_pressure_angle) / math.cos(self.helix_angle))

    @cached_property
    def base_helix_angle(self) -> float:
        """beta_b, rad; with the sign of the helix angle."""
        return math.asin(math.sin(self.helix_angle) * math.cos(self.normal_pressure_angle))

    @cached_property
    def reference_radius(self) -> float:
        """Reference radius d / 2, m."""
        return 0.5 * self.teeth * self.transverse_module

    @cached_property
    def base_radius(self) -> float:
        """d_b / 2, m."""
        return self.reference_radius * math.cos(self.transverse_pressure_angle)

    @cached_property
    def tip_radius(self) -> float:
        """d_a / 2, m; the teeth of an internal gear point inwards: its smallest radius."""
        if self.tip_diameter is not None:
            return 0.5 * self.tip_diameter
        height = self.addendum_coefficient + self.profile_shift_coefficient
        return self.reference_radius + self.sign * self.normal_module * height

    @cached_property
    def generating_shift_coefficient(self) -> float:
        """Addendum modification for generating x_E (ISO 21771-1), in normal modules.

        If the cutter removes the thickness allowance A, x_E = x - A / (2 m_n tan(alpha_n)), also of a ring
        gear, whose teeth a smaller shift makes thinner too. If the flanks are ground, x_E = x.
        """
        if self.tooth_thinning == FLANK:
            return self.profile_shift_coefficient
        infeed = cutter_infeed(self.thickness_allowance, self.normal_pressure_angle)
        return self.profile_shift_coefficient - infeed / self.normal_module

    @property
    def flank_grinding_allowance(self) -> float:
        """Normal tooth thickness in m that grinding of the flanks removes from the generated tooth."""
        return self.thickness_allowance if self.tooth_thinning == FLANK else 0.0

    def generated_shape(self, names: Collection[str]) -> Json:
        """Return fields of the gear as plain numbers, x_E as the shift, and the allowance of grinding alone.

        So gears of equal shape have equal fields: the shape depends on x_E, not on the nominal shift.
        """
        cut = {
            "profile_shift_coefficient": self.generating_shift_coefficient,
            "thickness_allowance": self.flank_grinding_allowance,
        }
        figures = {name: getattr(self, name) for name in names} | cut
        return {name: float(value) + 0.0 for name, value in figures.items()}  # -0.0 becomes 0.0

    @cached_property
    def root_radius(self) -> float:
        """d_f / 2: m_n (h_fP - x_E) below the reference circle (beyond it for an internal gear), m."""
        depth = self.dedendum_coefficient - self.generating_shift_coefficient
        return self.reference_radius - self.sign * self.normal_module * depth

    @property
    def period(self) -> int:
        """Number of teeth after which the gear's deviations repeat: 1 where all teeth are alike."""
        turning = deviations_period(self.run_out, self.waves, self.tooth_flanks, self.teeth)
        return math.lcm(self.pitch_deviation.period, turning)

    @property
    def deviates(self) -> bool:
        """Whether the axis of the teeth, waves or flanks of teeth differ from the designed gear."""
        several = (wave.amplitude for wave in self.waves), (not flank.neutral for flank in self.tooth_flanks)
        return not self.run_out.neutral or any(map(any, several))

    @property
    def turning_back(self) -> Self:
        """The gear with its teeth in the order in which they mesh in the other sense of rotation."""
        return replace(
            self,
            pitch_deviation=self.pitch_deviation.reversed,
            run_out=self.run_out.reversed,
            waves=tuple(wave.reversed for wave in self.waves),
            tooth_flanks=turned_back(self.tooth_flanks, self.teeth),
        )

    def right_handed(self) -> Self:
        """Return the gear if it is spur or right hand, else its mirror image."""
        return replace(self, helix_angle=abs(self.helix_angle))

    def unmodified(self) -> Self:
        """Return the gear that is meshed: flanks as involute helicoids, all teeth alike."""
        return replace(
            self,
            modification=UNMODIFIED,
            pitch_deviation=NO_PITCH_DEVIATION,
            run_out=NO_RUN_OUT,
            waves=(),
            tooth_flanks=(),
        )

    def with_parts(self, parts: Collection[str]) -> Toothing:
        """Return the gear without the optional parts of its body that are not among `parts`.

        An external gear has a ``blank`` (without it the body is solid) and a ``seat`` (without it the whole
        bore is fixed); other kinds have none.
        """
        return self

    @property
    def sector_teeth(self) -> int | None:
        """Number of teeth between two fixed cut planes; None for a whole body."""
        return None

    @property
    def whole(self) -> Toothing:
        """The gear whose body is no sector."""
        return self

    @property
    def seat(self) -> BoreSeat:
        """The seat of the gear at `seat_radius`."""
        return CLAMPED

    @property
    def web(self) -> Web | None:
        """Web between rim and hub, where the body is narrower than the face; None for a solid body."""
        return None

    @property
    def rim_inside_radius(self) -> float:
        """Radius to which the body is as wide as the face: to a web, or where the gear is held, m."""
        return self.seat_radius if self.web is None else self.web.outer_radius

    @property
    def rim_thickness(self) -> float:
        """s_R, from the root circle to `rim_inside_radius`, m."""
        return self.body_depth if self.web is None else self.root_radius - self.web.outer_radius

    @property
    def body_depth(self) -> float:
        """Distance in m from the root circle to the circle that the gear is held by: rim and web."""
        return self.sign * (self.root_radius - self.seat_radius)

    @cached_property
    def base_pitch(self) -> float:
        """Transverse base pitch p_bt, m."""
        return 2.0 * math.pi * self.base_radius / self.teeth

    @cached_property
    def tooth_thickness(self) -> float:
        """Transverse tooth thickness s_t at the reference circle (arc), m."""
        shift = 2.0 * self.generating_shift_coefficient * math.tan(self.normal_pressure_angle)
        normal = self.normal_module * (0.5 * math.pi + shift) - self.flank_grinding_allowance
        return normal / math.cos(self.helix_angle)

    @cached_property
    def base_thickness_half_angle(self) -> float:
        """Half the tooth's angle at the base circle psi_b, rad.

        The flanks of an internal tooth are extended to the base circle, past its tip; there they may have
        crossed (< 0).
        """
        at_reference = 0.5 * self.tooth_thickness / self.reference_radius
        return at_reference + self.sign * involute_function(self.transverse_pressure_angle)

    @property
    def base_tooth_thickness(self) -> float:
        """Transverse tooth thickness s_bt at the base circle (arc), m."""
        return 2.0 * self.base_radius * self.base_thickness_half_angle

    @property
    def tip_tooth_thickness(self) -> float:
        """Transverse tooth thickness s_at at the tip circle (arc), m; <= 0 is a pointed tooth."""
        pressure = math.acos(min(1.0, self.base_radius / self.tip_radius))
        half_angle = self.base_thickness_half_angle - self.sign * involute_function(pressure)
        return 2.0 * self.tip_radius * half_angle

    @property
    def form_roll_length(self) -> float:
        """Roll length of the form point, m, >= 0; the largest of an internal gear."""
        return self.form_point.roll_length

    @property
    def form_radius(self) -> float:
        """d_Ff / 2: radius at which involute and fillet meet, m."""
        return math.hypot(self.base_radius, self.form_roll_length)

    @cached_property
    def tip_roll_length(self) -> float:
        """Roll length of the tip edge, m."""
        return self.roll_length(self.tip_radius)

    @cached_property
    def tip_form_roll_length(self) -> float:
        """Roll length at which the usable flank ends, m: the tip edge, unless it is rounded or chamfered."""
        return self.modification.tip_form_roll_length(self)

    @property
    def tip_form_radius(self) -> float:
        """d_Fa / 2: radius at which the usable flank ends, m."""
        if self.tip_form_roll_length == self.tip_roll_length:
            return self.tip_radius
        return math.hypot(self.base_radius, self.tip_form_roll_length)

    def roll_length(self, radius: float) -> float:
        """Roll length in m at `radius` >= base radius."""
        return roll_length_at_radius(self.base_radius, radius)

    def flank_coordinate(self, roll_length: FloatArray | float) -> FloatArray:
        """Flank coordinate s in m at a roll length in m; negative on a ring gear (see `FlankProfile`)."""
        return np.asarray(self.sign * np.square(roll_length) / (2.0 * self.base_radius))
