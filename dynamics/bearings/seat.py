"""A bearing's five directions, and its stiffness and damping in them: what all linear bearings share."""

from __future__ import annotations

import numpy as np

from bounds import Declared, Kind, between
from dynamics.bearings.matrix import PRECISION, Matrix, check_matrix
from dynamics.checks import declared_fields, finite
from dynamics.errors import InputError
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


class Seat:
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
            if getattr(self, name) is not None:
                _check_matrix(name, getattr(self, name))
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


def _check_matrix(field: str, rows: Matrix) -> None:
    """Refuse what is no matrix of a bearing."""
    matrix = check_matrix(field, rows, (SEAT, SEAT + 1))
    if np.any(np.abs(matrix[SEAT:]) > PRECISION * np.max(np.abs(matrix))):
        bound = "zero in the row and column of the rotation about the axis"
        raise InputError(field, matrix[SEAT:].tolist(), bound, "A bearing lets its shaft turn.")
