"""A linear bearing: springs and dampers between a point of a shaft's axis and the ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.checks import finite, not_negative
from dynamics.errors import InputError
from dynamics.joints.matrix import Matrix, check_matrix
from dynamics.types import FloatArray

DEFAULT_DAMPING_RATIO = 0.05
SEAT = 5
"""Directions in which a bearing holds a shaft: x, y, z, tilt_x, tilt_y."""


@dataclass(frozen=True)
class Bushing:
    """A bushing between a shaft and the ground.

    The shaft's section at the bushing moves by d = (x, y, z, tilt_x, tilt_y); the bushing pushes the ground
    with K d + C d' - preload, forces and moments about its centre, in N, m, rad. The radial and axial figures
    are the isotropic part of K and C; a matrix is added to them.

    Attributes
    ----------
    name : str
        Unique among the bushings.
    shaft : str
        The shaft it carries.
    position : float
        Along the shaft, m from the shaft's left end.
    radial_stiffness, axial_stiffness : float
        N/m, >= 0.
    radial_damping, axial_damping : float or None
        N s/m. None: ``2 damping_ratio sqrt(stiffness * mass)`` with the mass of the shaft and its gears
        divided by the number of its bushings, so that the shaft bouncing on equal bushings has this
        damping ratio.
    damping_ratio : float
        Used where a damping is None.
    stiffness, damping : 5 by 5 or 6 by 6 matrices or None
        Added, in (x, y, z, tilt_x, tilt_y): tilt stiffness, cross terms; symmetric, positive semidefinite. Of
        a 6 by 6 matrix the row and column of the rotation about the axis are zero: the shaft turns. Without
        a damping matrix a stiffness matrix is damped in proportion, by `damping_ratio` at the frequency at
        which the bushing's share of the mass bounces on the matrix's largest stiffness.
    preload : five floats or None
        Force and moment of the bushing on the shaft where d = 0, N and N m, in the same order.
    """

    name: str
    shaft: str
    position: float
    radial_stiffness: float = 0.0
    axial_stiffness: float = 0.0
    radial_damping: float | None = None
    axial_damping: float | None = None
    damping_ratio: float = DEFAULT_DAMPING_RATIO
    stiffness: Matrix | None = None
    damping: Matrix | None = None
    preload: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        finite("position", self.position)
        for name in ("radial_stiffness", "axial_stiffness", "damping_ratio"):
            not_negative(name, getattr(self, name))
        for name in ("radial_damping", "axial_damping"):
            if getattr(self, name) is not None:
                not_negative(name, getattr(self, name))
        for name in ("stiffness", "damping"):
            if getattr(self, name) is not None:
                _check_seat(name, np.asarray(getattr(self, name), dtype=float))
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
        return self._isotropic(self.radial_stiffness, self.axial_stiffness) + self.added_stiffness

    @property
    def seat_damping(self) -> FloatArray:
        """C, (5, 5); what is left to be filled in from the damping ratio counts 0."""
        isotropic = self._isotropic(self.radial_damping or 0.0, self.axial_damping or 0.0)
        return isotropic + seat_matrix(self.damping)

    @staticmethod
    def _isotropic(radial: float, axial: float) -> FloatArray:
        return np.diag([radial, radial, axial, 0.0, 0.0])


def seat_matrix(matrix: Matrix | None) -> FloatArray:
    """Return a matrix without its rotation about the axis, (5, 5); zeros for None."""
    if matrix is None:
        return np.zeros((SEAT, SEAT))
    return np.array(matrix, dtype=float)[:SEAT, :SEAT]


def _check_seat(field: str, matrix: FloatArray) -> None:
    """Refuse what is no matrix of a bearing."""
    check_matrix(field, matrix, (SEAT, SEAT + 1))
    if np.any(matrix[SEAT:] != 0.0):
        bound = "zero in the row and column of the rotation about the axis"
        raise InputError(field, matrix[SEAT:].tolist(), bound, "A bearing lets its shaft turn.")
