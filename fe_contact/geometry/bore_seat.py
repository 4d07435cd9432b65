"""How the bore of a gear sits on its shaft."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING

from fe_contact.checks import finite, positive
from fe_contact.errors import InfeasibleGeometry
from fe_contact.types import Json

if TYPE_CHECKING:
    from fe_contact.geometry.gear import Gear
    from fe_contact.geometry.toothing import Toothing

NARROWEST = 0.02  # seat in face widths
FOUNDATIONS = ("radial_foundation", "tangential_foundation", "axial_foundation")


@dataclass(frozen=True)
class BoreSeat:
    """A seat all round the bore, rigid or elastic, over the whole face or part of it.

    Attributes
    ----------
    radial_foundation, tangential_foundation, axial_foundation : float, optional
        Foundation modulus: traction per displacement, N/m^3; None is rigid. It pulls as well as it
        pushes, as a fit does until it opens.
    width : float, optional
        Axial length of the seat, m; default: the face width.
    offset : float
        Axial distance of its middle from mid-face, m.

    Raises
    ------
    InputError
        A value out of its bounds.
    """

    radial_foundation: float | None = None
    tangential_foundation: float | None = None
    axial_foundation: float | None = None
    width: float | None = None
    offset: float = 0.0

    def __post_init__(self) -> None:
        for field in FOUNDATIONS:
            if getattr(self, field) is not None:
                positive(field, getattr(self, field), "In N/m^3: 1e13 is 10 N/mm^2 per um. Left out: rigid.")
        if self.width is not None:
            positive("width", self.width, "In m: 20 mm is 0.02. Left out: the face width.")
        finite("offset", self.offset, "In m, from mid-face.")

    @property
    def stiffness(self) -> tuple[float, float, float]:
        """Radial, tangential and axial foundation modulus, N/m^3; inf is rigid."""
        first, second, third = (getattr(self, field) for field in FOUNDATIONS)
        return tuple(math.inf if k is None else float(k) for k in (first, second, third))  # type: ignore[return-value]

    @property
    def elastic(self) -> bool:
        """Whether any direction gives way."""
        return any(math.isfinite(k) for k in self.stiffness)

    def ends(self, face_width: float) -> tuple[float, float]:
        """Return the axial positions of both ends of the seat, m."""
        half = 0.5 * (face_width if self.width is None else self.width)
        return max(self.offset - half, -0.5 * face_width), min(self.offset + half, 0.5 * face_width)

    def mirrored(self) -> BoreSeat:
        """Return the mirror image in the plane of mid-face."""
        return replace(self, offset=0.0 - self.offset)

    def content(self) -> Json:
        """Return all fields as plain JSON."""
        return asdict(self)


CLAMPED = BoreSeat()
"""The whole bore is fixed."""


def seat_compliance(gear: Toothing) -> float:
    """Displacement along the line of action per normal force that rotation on an elastic seat adds, m/N.

    r_b^2 / k_torsion with k_torsion = 2 pi r^3 w k_t: the gear turns as a rigid body.
    """
    stiffness = gear.seat.stiffness[1]
    if math.isinf(stiffness):
        return 0.0
    low, high = gear.seat.ends(gear.face_width)
    torsion = 2.0 * math.pi * gear.held_radius**3 * (high - low) * stiffness
    return gear.base_radius**2 / torsion


def refuse_misfit_seat(gear: Gear) -> None:
    """Raise `InfeasibleGeometry` if the seat of a gear leaves its face."""
    seat, face = gear.seat, gear.face_width
    width = face if seat.width is None else seat.width
    if not NARROWEST * face <= width <= (1.0 + 1e-9) * face:
        bound = f"from {NARROWEST * face:.6g} to the face width {face:.6g} m"
        raise InfeasibleGeometry("seat", "seat.width", seat.width, bound, "Leave it out for the face width.")
    room = 0.5 * (face - width)
    if abs(seat.offset) > room + 1e-9 * face:
        bound = f"from {-room:.6g} to {room:.6g} m, so that the seat stays within the face"
        raise InfeasibleGeometry("seat", "seat.offset", seat.offset, bound, "Lower the offset or the width.")
