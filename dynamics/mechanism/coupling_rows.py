"""Couplings between shafts as six strains each, with their matrices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.bearings.matrix import Matrix
from dynamics.bearings.seat import SEAT
from dynamics.joints import Coupling
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import column_count, section_rows
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

ROTATION = 5  # index of the rotation about the axis among six strains


ACROSS = (0, 1, 3, 4)
"""Strains that a rotating frame mixes: x, y, tilt_x, tilt_y."""


QUARTER = np.zeros((SEAT, SEAT))
QUARTER[[0, 1, 3, 4], [1, 0, 4, 3]] = -1.0, 1.0, -1.0, 1.0
"""Quarter turn about z (z x) of a seat's displacement and of its tilt."""


@dataclass(frozen=True)
class CouplingRows:
    """c couplings."""

    name: tuple[str, ...]
    motion: FloatArray
    """Strain per freedom: motion of the second shaft at the coupling less that of the first, m and rad. Shape
    (c, 6, N).
    """
    stiffness: FloatArray
    damping: FloatArray
    """`stiffness`, `damping`: Force and moment per strain and its rate, N, m, rad, s; across frames only
    those along the axis and about it. Shape (c, 6, 6) each.
    """

    def matrix(self, coefficient: FloatArray, left: FloatArray, right: FloatArray) -> FloatArray:
        """Return left^T coefficient right for strains (c, 6, a) and (c, 6, b)."""
        return np.asarray(np.einsum("cki,ckl,clj->ij", left, coefficient, right))


def gather_couplings(scene: Scene, rotors: Bodies) -> CouplingRows:
    """Return the strains of all couplings in the freedoms of the rotors, with their matrices."""
    motion = np.zeros((len(scene.couplings), 6, column_count(rotors)))
    for index, coupling in enumerate(scene.couplings):
        first, second = scene.shaft_index(coupling.first), scene.shaft_index(coupling.second)
        position = np.add(scene.shafts[first].origin, (0.0, 0.0, coupling.position))
        for shaft, sign in ((first, -1.0), (second, 1.0)):
            motion[index] += sign * section_rows(rotors, shaft, position[2])
    stiffness = [
        _constant(scene, c, full_matrix(c.stiffness, c.torsional_stiffness)) for c in scene.couplings
    ]
    damping = [_constant(scene, c, full_matrix(c.damping, c.torsional_damping)) for c in scene.couplings]
    return CouplingRows(
        tuple(coupling.name for coupling in scene.couplings),
        motion,
        np.array(stiffness).reshape(-1, 6, 6),
        np.array(damping).reshape(-1, 6, 6),
    )


def _constant(scene: Scene, coupling: Coupling, matrix: FloatArray) -> FloatArray:
    """Return the part of a coupling's `matrix` (6, 6) that no frame turns: all, or motion along the axis."""
    if not scene.crosses_frames(coupling):
        return matrix
    constant = matrix.copy()
    constant[list(ACROSS)], constant[:, list(ACROSS)] = 0.0, 0.0
    return constant


def full_matrix(matrix: Matrix | None, torsional: float) -> FloatArray:
    """Return the whole 6 by 6 matrix."""
    full = np.zeros((6, 6)) if matrix is None else np.array(matrix, dtype=float)
    full[ROTATION, ROTATION] += torsional
    return full
