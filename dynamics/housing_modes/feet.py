"""Feet of a housing: fixed, or on elastic mounts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.bearings.matrix import Matrix, check_matrix
from dynamics.errors import InputError
from dynamics.housing_modes.faces import Face
from dynamics.types import FloatArray

PRECISION = 1e-6
"""Relative; a data sheet or a finite-element program writes its matrices with that many digits."""


@dataclass(frozen=True)
class Mount:
    """A spring and damper between a rigid foot and the ground, at the centroid of the foot's face.

    Attributes
    ----------
    stiffness : 3 by 3 or 6 by 6 matrix
        Along the axes of the mesh: forces per displacements in N/m, and with six rows moments and rotations,
        N, N m per m, rad. Symmetric, positive semidefinite.
    damping : matrix of the same size or None
        N s/m ...; None: none.
    """

    stiffness: Matrix
    damping: Matrix | None = None

    def __post_init__(self) -> None:
        rows = len(check_matrix("stiffness", self.stiffness, (3, 6), PRECISION))
        if self.damping is not None:
            check_matrix("damping", self.damping, (rows,), PRECISION)

    def matrices(self) -> tuple[FloatArray, FloatArray]:
        """Return stiffness and damping, both (6, 6)."""
        return _six(self.stiffness), _six(self.damping)


@dataclass(frozen=True)
class Foot:
    """A face of the housing that stays plane and stands on the ground.

    Attributes
    ----------
    name : str
    face : Face
    mount : Mount or None
        None: fixed.
    """

    name: str
    face: Face
    mount: Mount | None = None

    def __post_init__(self) -> None:
        if not self.name:
            raise InputError("name", self.name, "a name")


def _six(matrix: Matrix | None) -> FloatArray:
    """Return a matrix with rows for rotations."""
    whole = np.zeros((6, 6))
    if matrix is not None:
        rows = len(matrix)
        whole[:rows, :rows] = 0.5 * (np.array(matrix) + np.array(matrix).T)
    return whole
