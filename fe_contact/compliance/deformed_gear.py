"""The mesh of a gear as it bends: displacement and stress at its nodes, for viewers and checks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class DeformedGear:
    """Finite elements of a gear, or of some of its teeth, under flank loads."""

    points: FloatArray
    """Nodes without load, m. As made: tooth 0 on +y, mid-face at z = 0; see `placed`. Shape (n, 3)."""
    cells: IntArray
    """Six-node triangles of the transverse section or 20-node hexahedra, numbered as in VTK. (m, 6) or (m,
    20) int array.
    """
    tooth: IntArray
    """Tooth number of each element, `fe_contact.mesh.export.HUB` in the hub. Shape (m,)."""
    displacement: FloatArray
    """Elastic displacement with the bore held, m. Shape (n, 3)."""
    stress: FloatArray
    """Mean of the adjoining elements' stresses, each extrapolated from its inner Gauss points, Pa. Shape (n,
    3, 3).
    """
    quality: Mapping[str, FloatArray]
    """Quality measures of the elements by name, (m,)."""
    flank_displacement: Mapping[int, FloatArray]
    """Displacement along the flank's normal by tooth number, m.

    Its entries are the degrees of freedom of the gear's flank compliance, in their order and with their sign.
    """
    residual: float
    """Norm of f - K u over the norm of f, on the freedoms of these elements that are neither fixed nor on a
    cut, where elements that are not here would add to the force.
    """

    @property
    def von_mises(self) -> FloatArray:
        """Equivalent stress after von Mises (n,), Pa."""
        deviator = self.stress - np.trace(self.stress, axis1=1, axis2=2)[:, None, None] * np.eye(3) / 3.0
        return np.asarray(np.sqrt(1.5 * np.sum(deviator**2, axis=(1, 2))))

    @property
    def principal_stress(self) -> FloatArray:
        """Principal stresses (n, 3), Pa, the least first."""
        return np.asarray(np.linalg.eigvalsh(self.stress))

    def turned_over(self) -> DeformedGear:
        """Return the gear seen from behind: turned by half a turn about y."""
        over = np.diag([-1.0, 1.0, -1.0])
        return replace(
            self,
            points=self.points @ over,
            displacement=self.displacement @ over,
            stress=over @ self.stress @ over,
        )

    def placed(self, angle: float, center: tuple[float, float, float]) -> DeformedGear:
        """Return the gear turned counter-clockwise by `angle` (rad) about its axis, its center moved (m)."""
        rotation_matrix = turn_about_axis(angle)
        return replace(
            self,
            points=self.points @ rotation_matrix.T + np.asarray(center),
            displacement=self.displacement @ rotation_matrix.T,
            stress=rotation_matrix @ self.stress @ rotation_matrix.T,
        )


def turn_about_axis(angle: float) -> FloatArray:
    """Return the matrix that turns vectors counter-clockwise about z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def nodal_mean(cells: IntArray, values: FloatArray, count: int) -> FloatArray:
    """Return the mean (count, ...) at each node of the values (m, p, ...) of its elements.

    `cells` (m, p): the p nodes of each element; nodes of no element have 0.
    """
    total = np.zeros((count, *values.shape[2:]))
    np.add.at(total, cells, values)
    times = np.bincount(cells.ravel(), minlength=count).reshape(-1, *(1,) * (values.ndim - 2))
    return np.asarray(total / np.maximum(times, 1))


def stress_of(gradient: FloatArray, lame: tuple[float, float]) -> FloatArray:
    """Return the stress lambda tr(g) I + mu (g + g') for displacement gradients g (..., 3, 3), Pa."""
    lam, mu = lame
    trace = np.trace(gradient, axis1=-2, axis2=-1)[..., None, None]
    return np.asarray(lam * trace * np.eye(3) + mu * (gradient + np.swapaxes(gradient, -1, -2)))
