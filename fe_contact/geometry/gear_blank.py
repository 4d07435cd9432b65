"""The body of a gear below its teeth: rim, web and hub (gear blank, ISO 6336-1)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from bounds import (
    LIMIT_SLACK,
    Declared,
    Kind,
    at_least,
    below,
    between,
    declared,
    described,
    required,
    up_to,
)
from fe_contact.checks import declared_fields
from fe_contact.errors import InfeasibleGeometry
from fe_contact.types import Json

if TYPE_CHECKING:
    from fe_contact.geometry.gear import Gear

THINNEST_RIM = 0.5  # in normal modules
THINNEST_WEB = 0.02  # in face widths
ROUNDING = 1e-4  # of the face width: faces closer than that are one, since foils of elements are no help


_RIM = "Rim thickness s_R below the root circle; half a module or more, less than what lies above the hub"
_WEB = "Web thickness b_s; 0.02 face widths to the face width, which is a solid gear"
_HUB = "Outside of the hub, the bore diameter or more; left out: the web reaches down to the bore"
_OFFSET = "Middle of the web towards +z from mid-face; the web stays within the face"


@described
@dataclass(frozen=True)
class GearBlank:
    """A rim as wide as the face, a web, and a hub as wide as the face.

    Raises
    ------
    InputError
        A value out of its bounds.
    """

    rim_thickness: float = required(Declared(Kind.LENGTH, "m", up_to(20.0), _RIM, 0.012))
    web_thickness: float = required(Declared(Kind.LENGTH, "m", up_to(5.0), _WEB, 0.01))
    hub_diameter: float | None = declared(None, Declared(Kind.LENGTH, "m", between(1e-6, 20.0), _HUB, 0.06))
    web_offset: float = declared(0.0, Declared(Kind.LENGTH, "m", between(-5.0, 5.0), _OFFSET, 0.005))

    def __post_init__(self) -> None:
        declared_fields(self)

    def mirrored(self) -> GearBlank:
        """Return the mirror image in the plane of mid-face."""
        return replace(self, web_offset=0.0 - self.web_offset)


@dataclass(frozen=True)
class Web:
    """Where the body is narrower than the face.

    Attributes
    ----------
    outer_radius, inner_radius : float
        Inside of the rim and outside of the hub, m.
    low, high : float
        Faces of the web along the axis, m; 0 is mid-face.
    """

    outer_radius: float
    inner_radius: float
    low: float
    high: float

    @property
    def thickness(self) -> float:
        """b_s, m."""
        return self.high - self.low

    def content(self) -> Json:
        """Return all fields as plain JSON."""
        return {name: float(value) for name, value in vars(self).items()}


def web_of(gear: Gear) -> Web | None:
    """Return the web of a gear, None if its body is as wide as the face all the way down."""
    blank = gear.blank
    if blank is None or blank.web_thickness >= (1.0 - ROUNDING) * gear.face_width:
        return None
    hub = gear.bore_diameter if blank.hub_diameter is None else blank.hub_diameter
    half, width = 0.5 * blank.web_thickness, 0.5 * gear.face_width
    low, high = max(blank.web_offset - half, -width), min(blank.web_offset + half, width)
    return Web(gear.root_radius - blank.rim_thickness, 0.5 * hub, low, high)


def refuse_misfit(gear: Gear) -> None:
    """Raise `InfeasibleGeometry` if the blank of a gear has no room in it."""
    blank = gear.blank
    if blank is None:
        return
    _refuse_rim(gear, blank)
    _refuse_web(gear, blank)


def _refuse_rim(gear: Gear, blank: GearBlank) -> None:
    """Refuse a hub inside the bore, a rim that leaves no web, and one that carries no teeth."""
    hub = gear.bore_diameter if blank.hub_diameter is None else blank.hub_diameter
    if hub < gear.bore_diameter:
        bound = at_least(gear.bore_diameter, "m", "the bore diameter")
        raise InfeasibleGeometry("hub", "blank.hub_diameter", hub, bound, "Raise it or leave it out.")
    least, deepest = THINNEST_RIM * gear.normal_module, gear.root_radius - 0.5 * hub
    if deepest <= least:
        field = "bore_diameter" if blank.hub_diameter is None else "blank.hub_diameter"
        widest = 2.0 * (gear.root_radius - least)
        bound = below(widest, "m", note=f", which leaves a rim of {THINNEST_RIM:g} normal modules")
        raise InfeasibleGeometry("rim", field, hub, bound, "Leave the blank out for a solid gear.")
    if not blank.rim_thickness < deepest:
        bound = below(deepest, "m", note=", what lies between root circle and hub (or bore)")
        advice = "Lower the rim thickness or the hub diameter; leave the blank out for a solid gear."
        raise InfeasibleGeometry("rim", "blank.rim_thickness", blank.rim_thickness, bound, advice)
    if blank.rim_thickness < least * (1.0 - LIMIT_SLACK):
        bound = at_least(least, "m", note=f", {THINNEST_RIM:g} normal modules")
        raise InfeasibleGeometry(
            "rim", "blank.rim_thickness", blank.rim_thickness, bound, "Raise the rim thickness."
        )


def _refuse_web(gear: Gear, blank: GearBlank) -> None:
    """Refuse a web that is a foil, or that leaves the face."""
    least = THINNEST_WEB * gear.face_width
    if not least * (1.0 - LIMIT_SLACK) <= blank.web_thickness <= (1.0 + 1e-9) * gear.face_width:
        bound = between(least, gear.face_width, "m", "the face width")
        advice = "A web as thick as the face is wide is a solid gear."
        raise InfeasibleGeometry("web", "blank.web_thickness", blank.web_thickness, bound, advice)
    room = 0.5 * (gear.face_width - blank.web_thickness)
    if abs(blank.web_offset) > room + 1e-9 * gear.face_width:
        bound = between(-room, room, "m", note=", so that the web stays within the face")
        advice = "Lower the offset or the web thickness."
        raise InfeasibleGeometry("web", "blank.web_offset", blank.web_offset, bound, advice)
