"""Modal freedoms eliminated from a steady vibration: exact, and as small as the system without them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from dynamics.arrays.modal_freedoms import ModalFreedoms
from dynamics.types import ComplexArray, FloatArray

ROUNDING = 1e-12
"""Largest error, over the largest entry of a matrix, with which the rows of the elements have to explain the
entries of the modal freedoms; it is rounding.
"""
Values = TypeVar("Values", FloatArray, ComplexArray)


@dataclass(frozen=True)
class _ModalElimination:
    """K, C and M by a bodies' freedoms and b modal ones, which s coordinates z = V u_b couple."""

    bodies: FloatArray
    """K, C, M of the first freedoms. Shape (3, a, a)."""
    modal: FloatArray
    """Diagonals of the modal ones alone. Shape (3, b)."""
    shape: FloatArray
    """V. Shape (s, b)."""
    outward: FloatArray
    inward: FloatArray
    along: FloatArray
    """`outward`, `inward`, `along`: Parts of K and C: forces on bodies by z, on z by the bodies, on z by z.
    (2, a, s), (2, s, a), (2, s, s) arrays.
    """

    def solve(
        self, omega: FloatArray | ComplexArray, right: ComplexArray, swept: Sequence[FloatArray] = ()
    ) -> ComplexArray:
        """Return the displacements (S, H, n, f) under the forces `right` (S, H, n, f) at `omega` (S, H).

        `swept` are gyroscopic and frame terms of the bodies (S, a, a), or nothing.
        """
        first = self.bodies.shape[1]
        inverse = 1.0 / _sum(omega, self.modal)
        receptance = self._receptance(inverse)
        into, along = _sum(omega, self.inward), _sum(omega, self.along)
        size = first + len(self.shape)
        matrix = np.empty((*omega.shape, size, size), dtype=complex)
        matrix[..., :first, :first] = self._of_bodies(omega, swept)
        matrix[..., :first, first:] = _sum(omega, self.outward)
        matrix[..., first:, :first] = receptance @ into
        matrix[..., first:, first:] = np.eye(len(self.shape)) + receptance @ along
        answer = right[..., first:, :] * inverse[..., None]
        pushed = np.concatenate([right[..., :first, :], self.shape @ answer], axis=-2)
        solution = solved(matrix, pushed)
        displacement, along_rows = solution[..., :first, :], solution[..., first:, :]
        force = into @ displacement + along @ along_rows
        return np.concatenate([displacement, answer - (self.shape.T @ force) * inverse[..., None]], axis=-2)

    def _receptance(self, inverse: ComplexArray) -> ComplexArray:
        """Return V diag(inverse) V^T (S, H, s, s) of `inverse` (S, H, b): one real product for all."""
        rows = len(self.shape)
        pairs = (self.shape[:, None] * self.shape).reshape(rows * rows, -1).T
        real, imaginary = (np.ascontiguousarray(part) @ pairs for part in (inverse.real, inverse.imag))
        return np.asarray((real + 1j * imaginary).reshape(*inverse.shape[:-1], rows, rows))

    def product(
        self, omega: FloatArray | ComplexArray, displacement: ComplexArray, swept: Sequence[FloatArray] = ()
    ) -> ComplexArray:
        """Return the forces (S, H, n, f) that a `displacement` (S, H, n, f) takes."""
        first = self.bodies.shape[1]
        out, into, along = (_sum(omega, part) for part in (self.outward, self.inward, self.along))
        bodies, modes = displacement[..., :first, :], displacement[..., first:, :]
        rows = self.shape @ modes
        modal_sum = _sum(omega, self.modal)[..., None] * modes
        pushed = modal_sum + self.shape.T @ (into @ bodies + along @ rows)
        return np.concatenate([self._of_bodies(omega, swept) @ bodies + out @ rows, pushed], axis=-2)

    def _of_bodies(self, omega: FloatArray | ComplexArray, swept: Sequence[FloatArray]) -> ComplexArray:
        """Return the bodies' own matrices, (S, H, a, a)."""
        matrix = _sum(omega, self.bodies)
        return matrix + turning_terms(omega[..., None, None], swept) if swept else matrix


def turning_terms(w: FloatArray | ComplexArray, swept: Sequence[FloatArray]) -> ComplexArray | float:
    """Return the gyroscopic and frame terms (S, n, n) of the matrix at `w` (S, H, 1, 1), rad/s."""
    return np.asarray(1j * w * swept[0][:, None] + swept[1][:, None]) if swept else 0.0


def _sum(omega: FloatArray | ComplexArray, parts: FloatArray) -> ComplexArray:
    """Return K + i w C - w^2 M at `omega` (S, H) of `parts` K, C and, if there are three, M (p, ...)."""
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
    """Return the elimination of a system's modal freedoms; None where it has none.

    Matrices (n, n) are those per `unit` (n,) of the freedoms, of tangents in all elements. None too where
    other than the rows of elements couple the modal freedoms, or where these rows depend on each other.
    """
    first = modal.first
    shape = (modal.shape * unit[first:])[np.unique(modal.row, return_index=True)[1]]
    if not shape.size or np.linalg.matrix_rank(shape) < len(shape):
        return None
    back, square = np.linalg.pinv(shape), unit[first:] ** 2
    parts = []
    for matrix, diagonal in ((stiffness, modal.stiffness * square), (damping, modal.damping * square)):
        out, into = matrix[:first, first:] @ back, back.T @ matrix[first:, :first]
        coupled = matrix[first:, first:] - np.diag(diagonal)
        along = back.T @ coupled @ back
        misses = (out @ shape - matrix[:first, first:], shape.T @ into - matrix[first:, :first])
        error = max(
            np.max(np.abs(part), initial=0.0) for part in (*misses, shape.T @ along @ shape - coupled)
        )
        if error > ROUNDING * np.max(np.abs(matrix)):
            return None
        parts.append((out, into, along, diagonal))
    out, into, along, diagonal = (np.stack(pair) for pair in zip(*parts, strict=True))
    bodies = np.stack([matrix[:first, :first] for matrix in (stiffness, damping, mass)])
    return _ModalElimination(
        bodies, np.concatenate([diagonal, np.diag(mass)[None, first:]]), shape, out, into, along
    )


def solved(matrix: Values, right: Values) -> Values:
    """Solve for all of a stack; an unbounded solution is not a number, and the caller refuses it."""
    try:
        return np.linalg.solve(matrix, right).astype(right.dtype, copy=False)
    except np.linalg.LinAlgError:
        return np.full_like(right, np.nan)
