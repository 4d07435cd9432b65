"""Elimination of modal freedoms from a steady vibration: exact, and as small as the system without them.

The a freedoms of bodies come first, then b modal freedoms u_b, which only force elements couple: through the
s coordinates z = V u_b. Axes: S speeds, H harmonics, n = a + b freedoms, f right sides. The dynamic stiffness
at the circular frequency w is K + i w C - w^2 M.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from dynamics.arrays.modal_freedoms import ModalFreedoms
from dynamics.types import ComplexArray, FloatArray

ROUNDING = 1e-12
"""Largest error, over the largest entry of a matrix, of its entries on modal freedoms when they are composed
of the rows of the force elements. It is rounding.
"""
Values = TypeVar("Values", FloatArray, ComplexArray)


@dataclass(frozen=True)
class _ModalElimination:
    """K, C and M in blocks: of the bodies, of the modal freedoms, and of the coupling through z."""

    bodies: FloatArray
    """K, C, M of the bodies' freedoms. Shape (3, a, a)."""
    modal: FloatArray
    """Diagonals of K, C, M of the modal freedoms without the coupling. Shape (3, b)."""
    shape: FloatArray
    """V. Shape (s, b)."""
    outward: FloatArray
    inward: FloatArray
    along: FloatArray
    """`outward`, `inward`, `along`: Parts of K and C that couple: forces on the bodies by z, on z by the
    bodies, on z by z. Shapes (2, a, s), (2, s, a), (2, s, s).
    """

    def solve(
        self, omega: FloatArray | ComplexArray, right: ComplexArray, swept: Sequence[FloatArray] = ()
    ) -> ComplexArray:
        """Return the displacements (S, H, n, f) under the forces `right` (S, H, n, f) at `omega` (S, H).

        `swept` are gyroscopic and frame terms of the bodies (S, a, a), or nothing.
        """
        first = self.bodies.shape[1]
        # unknowns: the bodies' displacements and z; with R = V diag(inverse) V^T the second rows are
        # R inward u_a + (1 + R along) z = V diag(inverse) right_b
        inverse = 1.0 / _sum(omega, self.modal)
        receptance = self._receptance(inverse)
        into, along = _sum(omega, self.inward), _sum(omega, self.along)
        size = first + len(self.shape)
        matrix = np.empty((*omega.shape, size, size), dtype=complex)
        matrix[..., :first, :first] = self._of_bodies(omega, swept)
        matrix[..., :first, first:] = _sum(omega, self.outward)
        matrix[..., first:, :first] = receptance @ into
        matrix[..., first:, first:] = np.eye(len(self.shape)) + receptance @ along
        uncoupled = right[..., first:, :] * inverse[..., None]  # modal displacements without the coupling
        reduced_right = np.concatenate([right[..., :first, :], self.shape @ uncoupled], axis=-2)
        solution = solved(matrix, reduced_right)
        displacement, z = solution[..., :first, :], solution[..., first:, :]
        modal = uncoupled - (self.shape.T @ (into @ displacement + along @ z)) * inverse[..., None]
        return np.concatenate([displacement, modal], axis=-2)

    def _receptance(self, inverse: ComplexArray) -> ComplexArray:
        """Return V diag(inverse) V^T (S, H, s, s) of `inverse` (S, H, b), by two products of real ones."""
        rows = len(self.shape)
        pairs = (self.shape[:, None] * self.shape).reshape(rows * rows, -1).T
        real, imaginary = (np.ascontiguousarray(part) @ pairs for part in (inverse.real, inverse.imag))
        return np.asarray((real + 1j * imaginary).reshape(*inverse.shape[:-1], rows, rows))

    def product(
        self, omega: FloatArray | ComplexArray, displacement: ComplexArray, swept: Sequence[FloatArray] = ()
    ) -> ComplexArray:
        """Return the forces (S, H, n, f) that cause a `displacement` (S, H, n, f)."""
        first = self.bodies.shape[1]
        out, into, along = (_sum(omega, part) for part in (self.outward, self.inward, self.along))
        bodies, modes = displacement[..., :first, :], displacement[..., first:, :]
        z = self.shape @ modes
        modal_force = _sum(omega, self.modal)[..., None] * modes + self.shape.T @ (into @ bodies + along @ z)
        return np.concatenate([self._of_bodies(omega, swept) @ bodies + out @ z, modal_force], axis=-2)

    def _of_bodies(self, omega: FloatArray | ComplexArray, swept: Sequence[FloatArray]) -> ComplexArray:
        """Return the dynamic stiffness of the bodies, gyroscopic and frame terms included, (S, H, a, a)."""
        matrix = _sum(omega, self.bodies)
        return matrix + turning_terms(omega[..., None, None], swept) if swept else matrix


def turning_terms(w: FloatArray | ComplexArray, swept: Sequence[FloatArray]) -> ComplexArray | float:
    """Return the gyroscopic and frame terms of the dynamic stiffness (S, H, n, n) at `w` (S, H, 1, 1), rad/s.

    `swept` has their damping and stiffness, (S, n, n) each; the result is 0 without any.
    """
    return np.asarray(1j * w * swept[0][:, None] + swept[1][:, None]) if swept else 0.0


def _sum(omega: FloatArray | ComplexArray, parts: FloatArray) -> ComplexArray:
    """Return K + i w C - w^2 M (S, H, ...) at `omega` (S, H); `parts` (2 or 3, ...) are K, C and maybe M."""
    by_part = np.stack([np.ones_like(omega), 1j * omega, -omega * omega], axis=-1)[..., : len(parts)]
    total = by_part.reshape(-1, len(parts)) @ parts.reshape(len(parts), -1)
    return np.asarray(total.reshape(*omega.shape, *parts.shape[1:]))


def modal_elimination(
    modal: ModalFreedoms,
    unit: FloatArray,
    stiffness: FloatArray,
    damping: FloatArray,
    mass: FloatArray,
) -> _ModalElimination | None:
    """Return the elimination of a system's modal freedoms.

    The result is None if the system has no modal freedoms, if anything but the rows of the force elements
    couples them, or if these rows are linearly dependent. The matrices (n, n), with the tangents of all
    elements, are per `unit` (n,) of the freedoms.
    """
    first = modal.first
    # repeated rows are padding
    shape = (modal.shape * unit[first:])[np.unique(modal.row, return_index=True)[1]]
    if not shape.size or np.linalg.matrix_rank(shape) < len(shape):
        return None
    back, square = np.linalg.pinv(shape), unit[first:] ** 2
    parts = []
    for matrix, diagonal in ((stiffness, modal.stiffness * square), (damping, modal.damping * square)):
        out, into = matrix[:first, first:] @ back, back.T @ matrix[first:, :first]
        coupled = matrix[first:, first:] - np.diag(diagonal)
        along = back.T @ coupled @ back
        # errors of the blocks when they are composed again of the rows
        errors = (
            out @ shape - matrix[:first, first:],
            shape.T @ into - matrix[first:, :first],
            shape.T @ along @ shape - coupled,
        )
        error = max(np.max(np.abs(part), initial=0.0) for part in errors)
        if error > ROUNDING * np.max(np.abs(matrix)):
            return None
        parts.append((out, into, along, diagonal))
    out, into, along, diagonal = (np.stack(pair) for pair in zip(*parts, strict=True))
    bodies = np.stack([matrix[:first, :first] for matrix in (stiffness, damping, mass)])
    return _ModalElimination(
        bodies, np.concatenate([diagonal, np.diag(mass)[None, first:]]), shape, out, into, along
    )


def solved(matrix: Values, right: Values) -> Values:
    """Return the solutions of a stack of equations; all NaN, which the caller refuses, if one is singular."""
    try:
        return np.linalg.solve(matrix, right).astype(right.dtype, copy=False)
    except np.linalg.LinAlgError:
        return np.full_like(right, np.nan)
