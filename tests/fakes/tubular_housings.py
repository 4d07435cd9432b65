"""Reduced housings of meshed tubes around z: a cantilever, and a short one of two seats."""

from functools import cache

from lattice_meshes import tube

from dynamics.housings import (
    Bore,
    Foot,
    Material,
    MaterialDamping,
    MeshedHousing,
    ModalDamping,
    Plane,
    ReducedHousing,
    SeatBore,
)
from dynamics.housings.reduction import reduce_housing

STEEL = Material(210e9, 0.3, 7850.0)
GROUND = Foot("base", Plane((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)))
RATIO = 0.005
OUTER, BORE, LENGTH = 0.024, 0.016, 0.4
"""Of the cantilever."""
SEAT = 0.04
"""Length of its seat."""


def _bore(z: float, length: float, diameter: float) -> Bore:
    return Bore((0.0, 0.0, z), (0.0, 0.0, 1.0), diameter, length)


@cache
def cantilever(modes: int = 12) -> ReducedHousing:
    """Slender and fixed at z = 0; its point is in the plane of its end, on x."""
    seat = SeatBore("end", _bore(LENGTH - SEAT / 2.0, SEAT, BORE))
    points = {"end": (OUTER / 2.0, 0.0, LENGTH)}
    mesh = tube(OUTER, BORE, LENGTH, (8, 1, 10))
    return reduce_housing(
        MeshedHousing(mesh, STEEL, (seat,), (GROUND,), points, modes, ModalDamping((RATIO,)))
    )


@cache
def two_seats(mounts: Foot = GROUND, modes: int = 12) -> ReducedHousing:
    """Short, of 12 by 8 cm, length 10 cm: a seat in each half, a point on its side and one on its end."""
    seats = (SeatBore("lower", _bore(0.025, 0.05, 0.08)), SeatBore("upper", _bore(0.075, 0.05, 0.08)))
    points = {"side": (0.06, 0.0, 0.05), "end": (0.0, 0.06, 0.1)}
    mesh = tube(0.12, 0.08, 0.1, (12, 1, 2))
    damping = MaterialDamping(2.0 * RATIO)
    return reduce_housing(MeshedHousing(mesh, STEEL, seats, (mounts,), points, modes, damping))
