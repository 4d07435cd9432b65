"""The body of a gear below its teeth: rim, web, hub (gear blank, ISO 6336-1) and the seat of its bore."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace

from bounds import Declared, Kind, Quantity, Text, between, declared, described, required, up_to
from fe_contact.errors import InputError, declared_fields
from fe_contact.types import Json

ROUNDING = 1e-4  # least difference of web and face width over the face width; a smaller one counts as none

_RIM = "Rim thickness s_R below the root circle; half a module or more, less than what lies above the hub"
_WEB = "Web thickness b_s; 0.02 face widths to the face width, which is a solid gear"
_HUB = "Outside of the hub, the bore diameter or more; left out: the web reaches down to the bore"
_WEB_OFFSET = "Middle of the web towards +z from mid-face; the web stays within the face"

_KEY = Text.of(
    "About G / h for a key of height h: ", Quantity(1e13, "N/m^3"), " for ", Quantity(8e-3, "m"), " of steel."
)

_ACROSS = "Width along the circumference"
_ANGLE = "Angle of its middle, counter-clockwise from the center line of the reference tooth at mid-face"
_WIDTH = "Axial length of the seat, 0.02 face widths or more; left out: the face width"
_KEYED = "A key; the tangential foundation is then its own"
_SEAT_OFFSET = "Middle of the seat towards +z from mid-face; the seat stays within the face"


@dataclass(frozen=True)
class Web:
    """A body that is narrower than the face."""

    outer_radius: float
    inner_radius: float
    """`outer_radius`, `inner_radius`: Inside of the rim and outside of the hub, m."""
    low: float
    high: float
    """`low`, `high`: Faces of the web along the axis, m; 0 is mid-face."""

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

    Raises `InputError`: a value out of its bounds.
    """

    rim_thickness: float = required(Declared(Kind.LENGTH, "m", up_to(20.0), _RIM, 0.012))
    web_thickness: float = required(Declared(Kind.LENGTH, "m", up_to(5.0), _WEB, 0.01))
    hub_diameter: float | None = declared(None, Declared(Kind.LENGTH, "m", between(1e-6, 20.0), _HUB, 0.06))
    web_offset: float = declared(0.0, Declared(Kind.LENGTH, "m", between(-5.0, 5.0), _WEB_OFFSET, 0.005))

    def __post_init__(self) -> None:
        declared_fields(self)

    def mirrored(self) -> GearBlank:
        """Return the mirror image in the plane of mid-face."""
        return replace(self, web_offset=0.0 - self.web_offset)  # 0, not -0, of an offset 0

    def web(self, face_width: float, root_radius: float, bore_diameter: float) -> Web | None:
        """Return the web in a gear of these sizes in m, None if its body is as wide as the face all down."""
        if self.web_thickness >= (1.0 - ROUNDING) * face_width:
            return None
        hub = bore_diameter if self.hub_diameter is None else self.hub_diameter
        half, width = 0.5 * self.web_thickness, 0.5 * face_width
        low, high = max(self.web_offset - half, -width), min(self.web_offset + half, width)
        return Web(root_radius - self.rim_thickness, 0.5 * hub, low, high)


def _foundation(direction: str, example: float) -> Declared:
    """Return the declaration of a foundation modulus: traction per displacement, N/m^3."""
    return Declared(
        Kind.STIFFNESS, "N/m^3", up_to(1e18), f"{direction} foundation modulus; left out: rigid", example
    )


@described
@dataclass(frozen=True)
class Key:
    """One parallel key along the axis.

    Raises `InputError`: a value out of its bounds.
    """

    width: float = required(Declared(Kind.LENGTH, "m", up_to(5.0), _ACROSS, 0.012))
    angle: float = declared(0.0, Declared(Kind.ANGLE, "rad", between(-math.pi, math.pi), _ANGLE, math.pi))

    def __post_init__(self) -> None:
        declared_fields(self)


@described
@dataclass(frozen=True)
class BoreSeat:
    """A seat all round the bore, rigid or elastic, over the whole face or part of it.

    Foundation moduli are traction per displacement, in tension and compression, as of a fit until it opens.
    With a key the tangential foundation is that of the key and must be given (about G / h for a key of height
    h). It acts over the width of the key only: elsewhere the bore slides around the shaft. Raises
    `InputError`: a value out of its bounds.
    """

    radial_foundation: float | None = declared(None, _foundation("Radial", 2e13))
    tangential_foundation: float | None = declared(None, _foundation("Tangential", 1e13))
    axial_foundation: float | None = declared(None, _foundation("Axial", 1e13))
    width: float | None = declared(None, Declared(Kind.LENGTH, "m", up_to(5.0), _WIDTH, 0.02))
    offset: float = declared(0.0, Declared(Kind.LENGTH, "m", between(-5.0, 5.0), _SEAT_OFFSET, 0.002))
    key: Key | None = declared(None, Declared(Kind.PART, "", None, _KEYED, part=Key))

    def __post_init__(self) -> None:
        declared_fields(self)
        if self.key is not None and self.tangential_foundation is None:
            raise InputError("tangential_foundation", None, "given with a key", _KEY)

    @property
    def key_modulus(self) -> float:
        """Tangential foundation modulus of the key, N/m^3; 0 without a key."""
        return 0.0 if self.key is None or self.tangential_foundation is None else self.tangential_foundation

    @property
    def stiffness(self) -> tuple[float, float, float]:
        """Radial, tangential and axial foundation modulus all round, N/m^3; inf is rigid."""
        radial, tangential, axial = (
            math.inf if modulus is None else float(modulus)
            for modulus in (self.radial_foundation, self.tangential_foundation, self.axial_foundation)
        )
        return radial, tangential if self.key is None else 0.0, axial

    @property
    def elastic(self) -> bool:
        """Whether any direction is elastic."""
        return any(math.isfinite(k) for k in self.stiffness)

    def ends(self, face_width: float) -> tuple[float, float]:
        """Return the axial positions of both ends of the seat, m."""
        half = 0.5 * (face_width if self.width is None else self.width)
        return max(self.offset - half, -0.5 * face_width), min(self.offset + half, 0.5 * face_width)

    def mirrored(self) -> BoreSeat:
        """Return the mirror image in the plane of mid-face."""
        return replace(self, offset=0.0 - self.offset)  # 0, not -0, of an offset 0

    def content(self) -> Json:
        """Return all fields as plain JSON."""
        return asdict(self)


CLAMPED = BoreSeat()
"""The whole bore is fixed."""
