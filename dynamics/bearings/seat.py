"""Linear bearings of a shaft to the ground or to a pin: stiffness, damping and preload in five directions.

The seat of a bearing is what holds its outer ring: the ground (or a housing), or the pin of a planet. The
five directions are x, y, z, tilt_x and tilt_y, z along the axis; the shaft turns freely about z.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bounds import Declared, Kind, between, declared, described, required
from dynamics.bearings.matrix import PRECISION, Matrix, check_matrix
from dynamics.checks import declared_fields, finite, not_negative
from dynamics.errors import InputError
from dynamics.shafts.bodies import TEMPERATURE
from dynamics.types import FloatArray

DEFAULT_DAMPING_RATIO = 0.05
"""Damping ratio of a shaft on its bearings where a scene states none."""
SEAT = 5
"""Number of directions in which a bearing holds a shaft: x, y, z, tilt_x, tilt_y."""

POSITION = Declared(
    Kind.LENGTH, "m", between(-1000.0, 1000.0), "Position along the shaft, from its left end", 0.0
)
RADIAL_STIFFNESS = Declared(
    Kind.STIFFNESS, "N/m", between(0.0, 1e15), "Radial stiffness; in all directions across the axis", 1e8
)
AXIAL_STIFFNESS = Declared(Kind.STIFFNESS, "N/m", between(0.0, 1e15), "Axial stiffness", 1e8)
RADIAL_DAMPING = Declared(
    Kind.DAMPING, "N s/m", between(0.0, 1e12), "Radial damping; left out: from damping_ratio", 1e3
)
AXIAL_DAMPING = Declared(
    Kind.DAMPING, "N s/m", between(0.0, 1e12), "Axial damping; left out: from damping_ratio", 1e3
)
DAMPING_RATIO = Declared(
    Kind.RATIO,
    "",
    between(0.0, 10.0),
    "Damping ratio of the shaft bouncing on its bearings, where a damping is left out",
    0.05,
)


SEAT_TEMPERATURE = replace(
    TEMPERATURE, description="Steady temperature of the housing at this seat; left out: that of the housing"
)
_RADIAL = Declared(
    Kind.DEVIATION, "m", between(-1e-2, 1e-2), "Position error of the pin, away from the carrier's axis", 0.0
)
_TANGENTIAL = Declared(
    Kind.DEVIATION, "m", between(-1e-2, 1e-2), "Position error of the pin, about +z", 20e-6
)


class _Seat:
    """Fields and matrices that linear bearings share.

    A bearing of stiffness K, damping C and preload p exerts the force K d + C d' - p on its seat, where d
    (5,) is the motion of the shaft against the seat. Radial and axial values are on the diagonals of K and C;
    the matrices `stiffness` and `damping` are added to them.
    """

    name: str
    shaft: str
    position: float
    radial_stiffness: float
    axial_stiffness: float
    radial_damping: float | None
    axial_damping: float | None
    damping_ratio: float
    stiffness: Matrix | None
    damping: Matrix | None
    preload: tuple[float, ...] | None

    def check_seat(self) -> None:
        """Raise `InputError` if the fields are not those of a linear bearing."""
        declared_fields(self)
        for name in ("stiffness", "damping"):
            if getattr(self, name) is None:
                continue
            # 5 by 5, or 6 by 6 with the rotation about the axis in the last row and column
            matrix = check_matrix(name, getattr(self, name), (SEAT, SEAT + 1))
            # matrix[SEAT:] is that last row, and empty for 5 by 5; the matrix is symmetric
            if np.any(np.abs(matrix[SEAT:]) > PRECISION * np.max(np.abs(matrix))):
                bound = "zero in the row and column of the rotation about the axis"
                raise InputError(name, matrix[SEAT:].tolist(), bound, "A bearing lets its shaft turn.")
        if self.preload is not None:
            if len(self.preload) != SEAT:
                raise InputError("preload", self.preload, "five numbers: x, y, z, tilt_x, tilt_y")
            for index, value in enumerate(self.preload):
                finite(f"preload[{index}]", value)

    @property
    def is_general(self) -> bool:
        """Whether the bearing is more than springs and dampers along x, y, z."""
        return self.stiffness is not None or self.damping is not None or self.preload is not None

    @property
    def added_stiffness(self) -> FloatArray:
        """The field `stiffness` alone, (5, 5), without radial and axial stiffness; zeros where it is None."""
        return seat_matrix(self.stiffness)

    @property
    def seat_stiffness(self) -> FloatArray:
        """K, (5, 5): radial and axial stiffness and the stiffness matrix."""
        return _isotropic(self.radial_stiffness, self.axial_stiffness) + self.added_stiffness

    @property
    def seat_damping(self) -> FloatArray:
        """C, (5, 5). A damping of None, which the damping ratio determines later, counts as 0."""
        isotropic = _isotropic(self.radial_damping or 0.0, self.axial_damping or 0.0)
        return isotropic + seat_matrix(self.damping)


def seat_matrix(matrix: Matrix | None) -> FloatArray:
    """Return a matrix without the row and column of the rotation about the axis, (5, 5); zeros for None."""
    if matrix is None:
        return np.zeros((SEAT, SEAT))
    return np.array(matrix, dtype=float)[:SEAT, :SEAT]


def _isotropic(radial: float, axial: float) -> FloatArray:
    return np.diag([radial, radial, axial, 0.0, 0.0])


@described
@dataclass(frozen=True)
class Bushing(_Seat):
    """A bushing between a shaft and the ground.

    The shaft's section at the bushing moves by d = (x, y, z, tilt_x, tilt_y); the bushing acts on the ground
    with K d + C d' - preload, forces and moments about its center, in N, m, rad. The radial and axial values
    are the isotropic part of K and C; a matrix is added to them.

    A damping that is None is ``2 damping_ratio sqrt(stiffness * mass)`` with the mass of the shaft and its
    gears divided by the number of its bushings, so that the shaft bouncing on equal bushings has this ratio.

    The matrices `stiffness` and `damping` add tilt stiffness and cross terms. They are 5 by 5 in (x, y, z,
    tilt_x, tilt_y), symmetric and positive semidefinite. They may be 6 by 6, with zeros in the row and column
    of the rotation about the axis, as the shaft turns.

    Without a damping matrix the damping is proportional to the stiffness matrix. It has `damping_ratio` at
    the natural frequency of the bushing's share of the mass on the largest stiffness of the matrix. If the
    matrix has tilt stiffness alone, the share of the transverse inertia takes the place of the mass.

    `preload` has five numbers: force and moment of the bushing on the shaft at d = 0, N and N m, in the same
    order.
    """

    name: str
    shaft: str
    position: float = required(POSITION)
    radial_stiffness: float = declared(0.0, RADIAL_STIFFNESS)
    axial_stiffness: float = declared(0.0, AXIAL_STIFFNESS)
    radial_damping: float | None = declared(None, RADIAL_DAMPING)
    axial_damping: float | None = declared(None, AXIAL_DAMPING)
    damping_ratio: float = declared(DEFAULT_DAMPING_RATIO, DAMPING_RATIO)
    stiffness: Matrix | None = None
    damping: Matrix | None = None
    preload: tuple[float, ...] | None = None
    seat_temperature: float | None = declared(None, SEAT_TEMPERATURE)

    def __post_init__(self) -> None:
        self.check_seat()


@described
@dataclass(frozen=True)
class PlanetBearing(_Seat):
    """A linear bearing between a point of a planet's axis and the pin in the carrier.

    The pin moves with the carrier as a rigid body: u_pin = u_carrier + r_carrier x lever. The force of the
    bearing on the pin is K d + C d' - preload. Here d = (x, y, z, tilt_x, tilt_y) is the motion of the
    planet's section less the motion and the position error of the pin. In matrices and preload x points away
    from the carrier's axis and y along z x (away), so that they are the same for all planets of a set.

    `name` is unique among planet bearings and bushings. `shaft` is the shaft of the planet, whose
    displacements are in the frame of `carrier`, the shaft of the carrier. A damping that is None follows from
    the damping ratio and the planet's mass divided by the number of its bearings. Matrices and `preload` are
    those of a `Bushing`.
    """

    name: str
    shaft: str
    carrier: str
    position: float = required(POSITION)
    radial_stiffness: float = declared(0.0, RADIAL_STIFFNESS)
    axial_stiffness: float = declared(0.0, AXIAL_STIFFNESS)
    radial_damping: float | None = declared(None, RADIAL_DAMPING)
    axial_damping: float | None = declared(None, AXIAL_DAMPING)
    damping_ratio: float = declared(DEFAULT_DAMPING_RATIO, DAMPING_RATIO)
    radial_error: float = declared(0.0, _RADIAL)
    tangential_error: float = declared(0.0, _TANGENTIAL)
    stiffness: Matrix | None = None
    damping: Matrix | None = None
    preload: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        self.check_seat()


@dataclass(frozen=True)
class BearingStiffness:
    """Stiffness of a bearing, or of all bearings of a shaft in place of one."""

    radial: float
    axial: float = 0.0
    """`radial`, `axial`: Stiffness across and along the axis, N/m, >= 0."""
    tilt: float = 0.0
    """Stiffness against a tilt about any axis across the shaft, N m/rad, >= 0."""

    def __post_init__(self) -> None:
        for name in ("radial", "axial", "tilt"):
            not_negative(name, getattr(self, name))

    @property
    def matrix(self) -> Matrix | None:
        """The stiffness matrix of the tilts alone, in x, y, z, tilt_x, tilt_y; None: no tilt stiffness."""
        if self.tilt == 0.0:
            return None
        diagonal = np.diag([0.0, 0.0, 0.0, self.tilt, self.tilt])
        return tuple(tuple(float(value) for value in row) for row in diagonal)
