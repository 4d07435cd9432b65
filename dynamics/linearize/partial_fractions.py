"""Receptances by partial fractions: one eigenvalue problem in place of a factorization a frequency."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.types import ComplexArray, FloatArray

MIN = 20
"""Freedoms from which on it is faster: 39 at 576 frequencies take 7 in place of 45 ms."""
PRECISE = 1e-10
"""Largest force left, of the largest exciting force: modes that almost depend on each other leave more."""


@dataclass(frozen=True)
class PartialFractions:
    """The inverse of K + i w C - w^2 M as X diag(1/(i w - r)) Y, for n freedoms."""

    stiffness: FloatArray
    mass: FloatArray
    damping: FloatArray
    """`stiffness`, `mass`, `damping`: Matrices of the system. Shape (n, n) each."""
    root: ComplexArray
    """Eigenvalues r of the motion of first order, rad/s. Shape (2 n,)."""
    shape: ComplexArray
    """X: displacements of its modes. Shape (n, 2 n)."""
    share: ComplexArray
    """Modal participation Y: excitation of each mode by forces. Shape (2 n, n)."""

    @classmethod
    def of(cls, stiffness: FloatArray, mass: FloatArray, damping: FloatArray) -> PartialFractions | None:
        """Solve the eigenvalue problem; None where modes depend on each other, or nothing is held."""
        count, square = len(mass), np.abs(np.diag(stiffness) / np.diag(mass))
        scale = float(np.sqrt(np.max(square, initial=0.0)))
        if count < MIN or not scale > 0.0:
            return None
        mobility = np.linalg.inv(mass)
        # derivative of the state: displacements times the scale, and rates
        motion = np.zeros((2 * count, 2 * count))
        motion[:count, count:] = scale * np.eye(count)
        motion[count:, :count] = -mobility @ stiffness / scale
        motion[count:, count:] = -mobility @ damping
        root, shape = np.linalg.eig(motion)
        pushed = np.vstack([np.zeros((count, count)), mobility / scale]).astype(complex)
        try:
            share = np.linalg.solve(shape, pushed)
        except np.linalg.LinAlgError:
            return None
        return cls(stiffness, mass, damping, root.astype(complex), shape[:count].astype(complex), share)

    def solve(self, omega: FloatArray | ComplexArray, right: ComplexArray) -> tuple[ComplexArray, FloatArray]:
        """Return the displacements (S, H, n, f) under `right`, and the residual of the first ones.

        `omega` (S, H), rad/s, `right` (S or 1, H, n, f).
        """
        excited = (self.share @ right) / (1j * omega[..., None, None] - self.root[:, None])
        displacement = np.asarray(self.shape @ excited)
        first, w = displacement[..., 0], omega[..., None]
        force = first @ self.stiffness.T + 1j * w * (first @ self.damping.T) - w * w * (first @ self.mass.T)
        return displacement, np.abs(force - right[..., 0])
