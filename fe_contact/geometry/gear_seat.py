"""A gear on its seat: fit of the seat, and its contribution to the compliance."""

from __future__ import annotations

import math

from bounds import LIMIT_SLACK, at_most, from_to
from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry.toothing import Toothing

NARROWEST = 0.02  # seat in face widths


def seat_compliance(gear: Toothing) -> float:
    """Return the displacement along the line of action per normal force by rotation on an elastic seat, m/N.

    It is r_b^2 / k_torsion with k_torsion = r^2 w a k_t, where a is 2 pi r or the width of a key: the gear
    turns as a rigid body.
    """
    key, modulus = gear.seat.key, gear.seat.tangential_foundation
    if modulus is None:
        return 0.0
    low, high = gear.seat.ends(gear.face_width)
    around = 2.0 * math.pi * gear.seat_radius if key is None else key.width
    torsion = gear.seat_radius**2 * around * (high - low) * modulus
    return gear.base_radius**2 / torsion


def refuse_misfit_seat(gear: Toothing) -> None:
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
    around = 2.0 * math.pi * gear.seat_radius
    if seat.key is not None and seat.key.width > (1.0 + 1e-9) * around:
        bound = at_most(around, "m", "the circumference of the bore")
        raise InfeasibleGeometry("key", "seat.key.width", seat.key.width, bound, "Lower the width.")
