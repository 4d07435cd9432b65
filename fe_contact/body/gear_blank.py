"""The body of a gear below its teeth: rim, web and hub (gear blank, ISO 6336-1)."""

from __future__ import annotations

from dataclasses import dataclass, replace

from bounds import Declared, Kind, between, declared, described, required, up_to
from fe_contact.checks import declared_fields
from fe_contact.types import Json

ROUNDING = 1e-4  # of the face width: faces closer than that are one, since foils of elements are no help


_RIM = "Rim thickness s_R below the root circle; half a module or more, less than what lies above the hub"
_WEB = "Web thickness b_s; 0.02 face widths to the face width, which is a solid gear"
_HUB = "Outside of the hub, the bore diameter or more; left out: the web reaches down to the bore"
_OFFSET = "Middle of the web towards +z from mid-face; the web stays within the face"


@dataclass(frozen=True)
class Web:
    """A body that is narrower than the face.

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

    def web(self, face_width: float, root_radius: float, bore_diameter: float) -> Web | None:
        """Return the web in a gear of these sizes in m, None if its body is as wide as the face all down."""
        if self.web_thickness >= (1.0 - ROUNDING) * face_width:
            return None
        hub = bore_diameter if self.hub_diameter is None else self.hub_diameter
        half, width = 0.5 * self.web_thickness, 0.5 * face_width
        low, high = max(self.web_offset - half, -width), min(self.web_offset + half, width)
        return Web(root_radius - self.rim_thickness, 0.5 * hub, low, high)
