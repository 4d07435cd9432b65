"""A bearing's five directions, its stiffness and damping in them: linear bearings to ground and pins."""

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
SEAT = 5
"""Directions in which a bearing holds a shaft: x, y, z, tilt_x, tilt_y."""

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
    Kind.SLOPE, "m", between(-1e-2, 1e-2), "Position error of the pin, away from the carrier's axis", 0.0
)
_TANGENTIAL = Declared(Kind.SLOPE, "m", between(-1e-2, 1e-2), "Position error of the pin, about +z", 20e-6)


class _Seat:
    """Stiffness K, damping C and preload p of a bearing: it pushes what holds it with K d + C d' - p.

    The isotropic figures are on the diagonals of K and C, the matrices are added to them.
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
        """Refuse what is no linear bearing."""
        declared_fields(self)
        for name in ("stiffness", "damping"):
            if getattr(self, name) is None:
                continue
            matrix = check_matrix(name, getattr(self, name), (SEAT, SEAT + 1))
            if np.any(np.abs(matrix[SEAT:]) > PRECISION * np.max(np.abs(matrix))):
                bound = "zero in the row and column of the rotation about the axis"
                raise InputError(name, matrix[SEAT:].tolist(), bound, "A bearing lets its shaft turn.")
        if self.preload is not None:
            if len(self.preload) != SEAT:
                raise InputError("preload", self.preload, "five numbers: x, y, z, tilt_x, tilt_y")
            for index, value in enumerate(self.preload):
                finite(f"preload[{index}]", value)

    @property
    def full(self) -> bool:
        """Whether it is more than three springs and dampers along x, y, z."""
        return self.stiffness is not None or self.damping is not None or self.preload is not None

    @property
    def added_stiffness(self) -> FloatArray:
        """The stiffness matrix alone, (5, 5); zeros without one."""
        return seat_matrix(self.stiffness)

    @property
    def seat_stiffness(self) -> FloatArray:
        """K, (5, 5): all of the stiffness."""
        return _isotropic(self.radial_stiffness, self.axial_stiffness) + self.added_stiffness

    @property
    def seat_damping(self) -> FloatArray:
        """C, (5, 5); what is left to be filled in from the damping ratio counts 0."""
        isotropic = _isotropic(self.radial_damping or 0.0, self.axial_damping or 0.0)
        return isotropic + seat_matrix(self.damping)


def seat_matrix(matrix: Matrix | None) -> FloatArray:
    """Return a matrix without its rotation about the axis, (5, 5); zeros for None."""
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

    The matrices `stiffness` and `damping`, 5 by 5 or 6 by 6 in (x, y, z, tilt_x, tilt_y), are symmetric and
    positive semidefinite: tilt stiffness, cross terms. In a 6 by 6 matrix the row and column of the rotation
    about the axis are zero: the shaft turns. Without a damping matrix damping is proportional to the
    stiffness matrix, with `damping_ratio` at the natural frequency of the bushing's share of the mass on the
    matrix's largest stiffness, or of its share of the transverse inertia on a matrix with tilt stiffness
    alone. `preload` are five numbers, force and moment of the bushing on the shaft at d = 0, N and N m, in
    the same order.
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
    """Stiffness of a bearing, or of all bearings of a shaft seen as one."""

    radial: float
    axial: float = 0.0
    """`radial`, `axial`: N/m, >= 0."""
    tilt: float = 0.0
    """About any axis across, N m/rad, >= 0."""

    def __post_init__(self) -> None:
        for name in ("radial", "axial", "tilt"):
            not_negative(name, getattr(self, name))

    @property
    def matrix(self) -> Matrix | None:
        """The part beyond radial and axial springs, in x, y, z, tilt_x, tilt_y; None: nothing."""
        if self.tilt == 0.0:
            return None
        return tuple(tuple(self.tilt if i == j >= 3 else 0.0 for j in range(5)) for i in range(5))
