"""The bearing of a planet on its pin, which turns with the carrier."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, between, declared, described, required
from dynamics.bearings import seat
from dynamics.bearings.matrix import Matrix

_RADIAL = Declared(
    Kind.SLOPE, "m", between(-1e-2, 1e-2), "Position error of the pin, away from the carrier's axis", 0.0
)
_TANGENTIAL = Declared(Kind.SLOPE, "m", between(-1e-2, 1e-2), "Position error of the pin, about +z", 20e-6)


@described
@dataclass(frozen=True)
class PlanetBearing(seat.Seat):
    """A linear bearing between a point of a planet's axis and the pin in the carrier.

    The pin moves with the carrier as a rigid body: u_pin = u_carrier + r_carrier x lever. The bearing pushes
    it with K d + C d' - preload, d = (x, y, z, tilt_x, tilt_y) the motion of the planet's section less that
    of the pin and its error. Matrices and preload count x away from the carrier's axis and y along
    z x (away), so that they are the same for all planets of a set.

    Its `name` is unique among the planet bearings and bushings; `shaft` is the planet's, its displacements
    described in the frame of `carrier`, the carrier's shaft. A damping that is None follows from the ratio
    and the planet's mass divided by the number of its bearings. Matrices and `preload` are as of a `Bushing`.
    """

    name: str
    shaft: str
    carrier: str
    position: float = required(seat.POSITION)
    radial_stiffness: float = declared(0.0, seat.RADIAL_STIFFNESS)
    axial_stiffness: float = declared(0.0, seat.AXIAL_STIFFNESS)
    radial_damping: float | None = declared(None, seat.RADIAL_DAMPING)
    axial_damping: float | None = declared(None, seat.AXIAL_DAMPING)
    damping_ratio: float = declared(seat.DEFAULT_DAMPING_RATIO, seat.DAMPING_RATIO)
    radial_error: float = declared(0.0, _RADIAL)
    tangential_error: float = declared(0.0, _TANGENTIAL)
    stiffness: Matrix | None = None
    damping: Matrix | None = None
    preload: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        self.check_seat()
