"""One external involute gear (ISO 21771-1): data and closed forms."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property

import numpy as np

from bounds import (
    LIMIT_SLACK,
    Declared,
    Kind,
    Quantity,
    Text,
    above,
    at_least,
    at_most,
    below,
    between,
    declared,
    described,
    from_to,
    required,
)
from fe_contact.body import CLAMPED, BoreSeat, GearBlank, Web
from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry.basic_rack import BasicRack
from fe_contact.geometry.fillet_curve import FormPoint, Trochoid, find_form_point
from fe_contact.geometry.toothing import Toothing, counted
from fe_contact.types import Json

# A gear on its seat: whether the seat fits, and what it adds to the compliance.

NARROWEST = 0.02  # seat in face widths


def seat_compliance(gear: Toothing) -> float:
    """Displacement along the line of action per normal force that rotation on an elastic seat adds, m/N.

    r_b^2 / k_torsion with k_torsion = r^2 w a k_t, a = 2 pi r or the width of a key: the gear turns as a
    rigid body.
    """
    key, modulus = gear.seat.key, gear.seat.tangential_foundation
    if modulus is None:
        return 0.0
    low, high = gear.seat.ends(gear.face_width)
    around = 2.0 * math.pi * gear.held_radius if key is None else key.width
    torsion = gear.held_radius**2 * around * (high - low) * modulus
    return gear.base_radius**2 / torsion


def _refuse_misfit_seat(gear: Toothing) -> None:
    """Raise `InfeasibleGeometry` if the seat of a gear leaves its face."""
    seat, face = gear.seat, gear.face_width
    width = face if seat.width is None else seat.width
    if not NARROWEST * face * (1.0 - LIMIT_SLACK) <= width <= (1.0 + 1e-9) * face:
        bound = from_to(NARROWEST * face, face, "m", "the face width")
        raise InfeasibleGeometry("seat", "seat.width", seat.width, bound, "Leave it out for the face width.")
    room = 0.5 * (face - width)
    if abs(seat.offset) > room + 1e-9 * face:
        bound = from_to(-room, room, "m", note=", so that the seat stays within the face")
        raise InfeasibleGeometry("seat", "seat.offset", seat.offset, bound, "Lower the offset or the width.")
    around = 2.0 * math.pi * gear.held_radius
    if seat.key is not None and seat.key.width > (1.0 + 1e-9) * around:
        bound = at_most(around, "m", "the circumference of the bore")
        raise InfeasibleGeometry("key", "seat.key.width", seat.key.width, bound, "Lower the width.")


# Refusal of gears that cannot exist, by the standard term for what is wrong.


THINNEST_RIM = 0.5  # in normal modules
THINNEST_WEB = 0.02  # in face widths


def _refuse_bore(gear: Toothing) -> None:
    """Refuse a bore that leaves no rim under the teeth."""
    bore = 2.0 * gear.held_radius
    if bore >= 2.0 * gear.root_radius:
        bound = below(2.0 * gear.root_radius, "m", "the root diameter")
        advice = "Lower the bore or add teeth."
        raise InfeasibleGeometry("bore", "bore_diameter", bore, bound, advice)


def _refuse_rim(gear: Toothing, blank: GearBlank) -> None:
    """Refuse a hub inside the bore, a rim that leaves no web, and one that carries no teeth."""
    bore = 2.0 * gear.held_radius
    hub = bore if blank.hub_diameter is None else blank.hub_diameter
    if hub < bore:
        bound = at_least(bore, "m", "the bore diameter")
        raise InfeasibleGeometry("hub", "blank.hub_diameter", hub, bound, "Raise it or leave it out.")
    least, deepest = THINNEST_RIM * gear.normal_module, gear.root_radius - 0.5 * hub
    if deepest <= least:
        field = "bore_diameter" if blank.hub_diameter is None else "blank.hub_diameter"
        widest = 2.0 * (gear.root_radius - least)
        bound = below(widest, "m", note=f", which leaves a rim of {THINNEST_RIM:g} normal modules")
        raise InfeasibleGeometry("rim", field, hub, bound, "Leave the blank out for a solid gear.")
    if not blank.rim_thickness < deepest:
        bound = below(deepest, "m", note=", the depth between root circle and hub (or bore)")
        advice = "Lower the rim thickness or the hub diameter; leave the blank out for a solid gear."
        raise InfeasibleGeometry("rim", "blank.rim_thickness", blank.rim_thickness, bound, advice)
    if blank.rim_thickness < least * (1.0 - LIMIT_SLACK):
        bound = at_least(least, "m", note=f", {THINNEST_RIM:g} normal modules")
        raise InfeasibleGeometry(
            "rim", "blank.rim_thickness", blank.rim_thickness, bound, "Raise the rim thickness."
        )


def _refuse_web(gear: Toothing, blank: GearBlank) -> None:
    """Refuse a web that is a foil, or that leaves the face."""
    least = THINNEST_WEB * gear.face_width
    if not least * (1.0 - LIMIT_SLACK) <= blank.web_thickness <= (1.0 + 1e-9) * gear.face_width:
        bound = from_to(least, gear.face_width, "m", "the face width")
        advice = "A web as thick as the face is wide is a solid gear."
        raise InfeasibleGeometry("web", "blank.web_thickness", blank.web_thickness, bound, advice)
    room = 0.5 * (gear.face_width - blank.web_thickness)
    if abs(blank.web_offset) > room + 1e-9 * gear.face_width:
        bound = from_to(-room, room, "m", note=", so that the web stays within the face")
        advice = "Lower the offset or the web thickness."
        raise InfeasibleGeometry("web", "blank.web_offset", blank.web_offset, bound, advice)


def _refuse_undercut(gear: Toothing) -> None:
    """Refuse a tip circle or a fillet that leaves no involute, or no material in the tooth's root."""
    advice = "Raise the tip diameter, the profile shift or the number of teeth, or lower the dedendum."
    if gear.form_radius >= gear.tip_radius:
        name = "undercut" if gear.form_point.undercut else "tip diameter"
        bound = above(2.0 * gear.form_radius, "m", "the form diameter", ", where the fillet ends")
        raise InfeasibleGeometry(name, "tip_diameter", 2.0 * gear.tip_radius, bound, advice)
    angles = np.linspace(gear.form_point.tool_angle, 0.5 * math.pi, 65)
    if gear.form_point.undercut and np.min(gear.trochoid.point(angles)[:, 0]) <= 0.0:
        larger = "larger: the fillets of both flanks cut the tooth off"
        raise InfeasibleGeometry(
            "undercut", "profile_shift_coefficient", gear.profile_shift_coefficient, larger, advice
        )


def _refuse_pointed_tooth(gear: Toothing) -> None:
    if gear.tip_tooth_thickness <= 0.0:
        thickness = Quantity(gear.tip_tooth_thickness, "m", digits=3)
        bound = Text.of("smaller: the transverse tip thickness is ", thickness)
        advice = "Lower the tip diameter, the addendum or the profile shift."
        raise InfeasibleGeometry("pointed tooth", "tip_diameter", 2.0 * gear.tip_radius, bound, advice)


_BORE = Declared(
    Kind.LENGTH, "m", between(1e-6, 500.0), "Bore diameter; below the root diameter", 0.04, with_unit=True
)
_BLANK = "Rim, web and hub; left out: a solid body"
_SEAT = "Seat of the bore; left out: the whole bore is fixed"


@described
@dataclass(frozen=True)
class Gear(Toothing):
    """An external cylindrical gear, generated by its basic rack.

    Besides what is declared: `modification`, `material` and `pitch_deviation` (see `Toothing`). Raises
    `InputError`: a value out of its bounds; `InfeasibleGeometry`: no such gear: "root radius", "bore", "rim",
    "web", "hub", "seat", "tip diameter", "undercut", "pointed tooth".
    """

    teeth: int = required(counted(4, 2000))
    bore_diameter: float = required(_BORE)
    _: KW_ONLY
    blank: GearBlank | None = declared(None, Declared(Kind.PART, "", None, _BLANK, part=GearBlank))
    seat: BoreSeat = declared(CLAMPED, Declared(Kind.PART, "", None, _SEAT, part=BoreSeat))

    def __post_init__(self) -> None:
        self._check_fields()
        _ = self.basic_rack
        blank = self.blank
        _refuse_bore(self)
        if blank is not None:
            _refuse_rim(self, blank)
            _refuse_web(self, blank)
        _refuse_misfit_seat(self)
        _refuse_undercut(self)
        _refuse_pointed_tooth(self)
        self._check_teeth()

    @cached_property
    def basic_rack(self) -> BasicRack:
        """The generating basic rack."""
        return BasicRack(
            self.normal_module,
            self.normal_pressure_angle,
            self.addendum_coefficient,
            self.dedendum_coefficient,
            self.root_radius_coefficient,
        )

    @property
    def held_radius(self) -> float:
        """Radius of the bore, m."""
        return 0.5 * self.bore_diameter

    @cached_property
    def trochoid(self) -> Trochoid:
        """The fillet of the right flank."""
        rack, angle = self.basic_rack, self.normal_pressure_angle
        height = self.root_radius - self.reference_radius + rack.root_radius
        flank_end = height - rack.root_radius * math.sin(angle)
        distance = 0.5 * self.tooth_thickness - flank_end * math.tan(self.transverse_pressure_angle)
        distance += rack.root_radius * math.cos(angle) / math.cos(self.helix_angle)
        return Trochoid(self.reference_radius, distance, height, rack.root_radius, self.helix_angle)

    @cached_property
    def form_point(self) -> FormPoint:
        """Where involute and fillet meet."""
        sine = math.sin(self.transverse_pressure_angle)
        flank_end = float(self.trochoid.height(np.array(self.normal_pressure_angle)))
        tangent_roll_length = self.reference_radius * sine + flank_end / sine
        return find_form_point(
            self.trochoid,
            self.normal_pressure_angle,
            tangent_roll_length,
            self.base_radius,
            self.base_thickness_half_angle,
        )

    @cached_property
    def web(self) -> Web | None:
        """Where the body is narrower than the face; None for a solid gear."""
        if self.blank is None:
            return None
        return self.blank.web(self.face_width, self.root_radius, self.bore_diameter)

    def with_parts(self, parts: Collection[str]) -> Gear:
        """Return the gear without the optional parts of its body that are not among `parts`."""
        plain = {"blank": None, "seat": CLAMPED}
        left_out = {name: value for name, value in plain.items() if name not in parts}
        same = all(getattr(self, name) == value for name, value in left_out.items())
        return self if same else replace(self, **left_out)  # type: ignore[arg-type]

    def right_handed(self) -> Gear:
        """Return the gear itself, or the mirror image in the plane of mid-face if it is left-handed."""
        if self.helix_angle >= 0.0:
            return self
        blank = None if self.blank is None else self.blank.mirrored()
        return replace(self, helix_angle=-self.helix_angle, blank=blank, seat=self.seat.mirrored())

    def macro_geometry(self) -> Json:
        """Return the shape of the unmodified gear as plain numbers (for content hashes).

        The addendum coefficient is absent, since it acts only through the tip diameter; so is the blank of a
        solid gear.
        """
        names = (
            "normal_module",
            "face_width",
            "bore_diameter",
            "normal_pressure_angle",
            "helix_angle",
            "dedendum_coefficient",
            "root_radius_coefficient",
        )
        counts = {"teeth": int(self.teeth)}
        body = {} if self.web is None else {"web": self.web.content()}
        return counts | {"tip_diameter": 2.0 * self.tip_radius} | self.generated_shape(names) | body
