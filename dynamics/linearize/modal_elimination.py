"""Forced vibration with the modal freedoms eliminated: exact, and as small as the system without them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dynamics.arrays.modal_freedoms import ModalFreedoms
from dynamics.types import FloatArray

ComplexArray = NDArray[np.complex128]
ROUNDING = 1e-12
"""Of the entries of modal freedoms, that the rows of their elements may fail to explain."""


@dataclass(frozen=True)
class ModalElimination:
    """K, C and M by a bodies' freedoms and b modal ones, which s coordinates z = V u_b couple.

    Attributes
    ----------
    bodies : (3, a, a) array
        K, C, M of the first freedoms.
    modal : (3, b) array
        Diagonals of the modal ones alone.
    shape : (s, b) array
        V.
    outward, inward, along : (2, a, s), (2, s, a), (2, s, s) arrays
        Of K and C: forces on bodies by z, on z by the bodies, on z by z.
    """

    bodies: FloatArray
    modal: FloatArray
    shape: FloatArray
    outward: FloatArray
    inward: FloatArray
    along: FloatArray

    def solve(
        self, omega: FloatArray | ComplexArray, right: ComplexArray, swept: Sequence[FloatArray] = ()
    ) -> ComplexArray:
        """Return the displacements (S, H, n, f) under the forces `right` (S, H, n, f) at `omega` (S, H).

        `swept` are gyroscopic and frame terms of the bodies (S, a, a), or nothing.
        """
        first, w = self.bodies.shape[1], omega[..., None, None]
        own = _sum(omega[..., None], self.modal)
        receptance = (self.shape / own[..., None, :]) @ self.shape.T
        out, into, along = (_sum(w, part) for part in (self.outward, self.inward, self.along))
        top = np.concatenate([_sum(w, self.bodies) + turning_terms(w, swept), out], axis=-1)
        unit = np.eye(len(self.shape))
        bottom = np.concatenate([receptance @ into, unit + receptance @ along], axis=-1)
        answer = right[..., first:, :] / own[..., None]
        pushed = np.concatenate([right[..., :first, :], self.shape @ answer], axis=-2)
        found = np.linalg.solve(np.concatenate([top, bottom], axis=-2), pushed)
        moved, along_rows = found[..., :first, :], found[..., first:, :]
        force = into @ moved + along @ along_rows
        return np.concatenate([moved, answer - (self.shape.T @ force) / own[..., None]], axis=-2)

    def product(
        self, omega: FloatArray | ComplexArray, moved: ComplexArray, swept: Sequence[FloatArray] = ()
    ) -> ComplexArray:
        """Return the forces (S, H, n, f) that the displacements `moved` (S, H, n, f) take."""
        first, w = self.bodies.shape[1], omega[..., None, None]
        out, into, along = (_sum(w, part) for part in (self.outward, self.inward, self.along))
        bodies, modes = moved[..., :first, :], moved[..., first:, :]
        rows = self.shape @ modes
        own = _sum(omega[..., None], self.modal)[..., None] * modes
        pushed = own + self.shape.T @ (into @ bodies + along @ rows)
        own_bodies = _sum(w, self.bodies) + turning_terms(w, swept)
        return np.concatenate([own_bodies @ bodies + out @ rows, pushed], axis=-2)


def turning_terms(w: FloatArray | ComplexArray, swept: Sequence[FloatArray]) -> ComplexArray | float:
    """Return what gyroscopic and frame terms (S, n, n) add to the matrix at `w` (S, H, 1, 1), rad/s."""
    return np.asarray(1j * w * swept[0][:, None] + swept[1][:, None]) if swept else 0.0


def _sum(omega: FloatArray | ComplexArray, parts: FloatArray) -> ComplexArray:
    """Return K + i w C - w^2 M of `parts` K, C and, if it has, M."""
    total = parts[0] + 1j * omega * parts[1]
    return np.asarray(total - omega * omega * parts[2] if len(parts) > 2 else total)


def modal_elimination(
    modal: ModalFreedoms,
    unit: FloatArray,
    stiffness: FloatArray,
    damping: FloatArray,
    mass: FloatArray,
) -> ModalElimination | None:
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
    for matrix, own in ((stiffness, modal.stiffness * square), (damping, modal.damping * square)):
        out, into = matrix[:first, first:] @ back, back.T @ matrix[first:, :first]
        coupled = matrix[first:, first:] - np.diag(own)
        along = back.T @ coupled @ back
        misses = (out @ shape - matrix[:first, first:], shape.T @ into - matrix[first:, :first])
        missed = max(
            np.max(np.abs(part), initial=0.0) for part in (*misses, shape.T @ along @ shape - coupled)
        )
        if missed > ROUNDING * np.max(np.abs(matrix)):
            return None
        parts.append((out, into, along, own))
    out, into, along, own = (np.stack(pair) for pair in zip(*parts, strict=True))
    bodies = np.stack([matrix[:first, :first] for matrix in (stiffness, damping, mass)])
    return ModalElimination(
        bodies, np.concatenate([own, np.diag(mass)[None, first:]]), shape, out, into, along
    )
