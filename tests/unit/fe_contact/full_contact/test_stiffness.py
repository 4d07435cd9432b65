"""Plane strain in six-node triangles: no force from rigid motion, exact in even strain."""

from __future__ import annotations

import numpy as np

from fe_contact.full_contact.condensation.contact_model import _plane_strain_stiffness
from fe_contact.material import Material

STEEL = Material(210e9, 0.3)
# two curved triangles that share a bent side
POINTS = 1e-3 * np.array(
    [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, -0.05], [1.06, 0.5], [0.53, 0.46], [0.5, 1.04], [-0.03, 0.5]]
)
TRIANGLES = np.array([[0, 1, 2, 4, 5, 6], [0, 2, 3, 6, 7, 8]])


def area() -> float:
    """Enclosed by the four quadratic sides."""
    total = 0.0
    points, weights = np.polynomial.legendre.leggauss(4)
    for a, m, b in ((0, 4, 1), (1, 5, 2), (2, 7, 3), (3, 8, 0)):
        shape = np.stack([0.5 * points * (points - 1), 1 - points**2, 0.5 * points * (points + 1)], axis=1)
        slope = np.stack([points - 0.5, -2 * points, points + 0.5], axis=1)
        at, along = shape @ POINTS[[a, m, b]], slope @ POINTS[[a, m, b]]
        total += 0.5 * float(weights @ (at[:, 0] * along[:, 1] - at[:, 1] * along[:, 0]))
    return total


def test_rigid_motion_takes_no_force() -> None:
    matrix = _plane_strain_stiffness(POINTS, TRIANGLES, STEEL).toarray()
    np.testing.assert_allclose(matrix, matrix.T, rtol=0.0, atol=1e-15 * matrix.max())
    turned = np.stack([-POINTS[:, 1], POINTS[:, 0]], axis=-1) / 1e-3
    for motion in (np.tile([1.0, 0.0], 9), np.tile([0.0, 1.0], 9), turned.ravel()):
        assert np.abs(matrix @ motion).max() < 1e-14 * matrix.max()
    assert np.sum(np.linalg.eigvalsh(matrix) > 1e-9 * matrix.max()) == len(matrix) - 3


def test_even_strain_stores_the_energy_of_plane_strain() -> None:
    matrix = _plane_strain_stiffness(POINTS, TRIANGLES, STEEL)
    e, nu = STEEL.youngs_modulus, STEEL.poissons_ratio
    lam, mu = e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))
    for strain in ([[1.0, 0.0], [0.0, 0.0]], [[0.3, 0.4], [0.4, -0.2]]):
        moved = (POINTS @ np.array(strain)).ravel()
        density = lam * np.trace(strain) ** 2 + 2.0 * mu * float(np.sum(np.square(strain)))
        np.testing.assert_allclose(moved @ (matrix @ moved), density * area(), rtol=1e-10)
