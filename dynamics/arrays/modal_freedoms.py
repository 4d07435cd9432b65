"""Modal freedoms and their compiled products.

A modal freedom is the amplitude of a mode. Its row of the mass, damping and stiffness matrices is diagonal,
so that only force elements couple it to other freedoms. Modal freedoms are the last freedoms of a system.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.kernels.compiled import inner, inner_sums
from dynamics.types import FloatArray, IntArray

MIN = 16
"""Least number of modal freedoms: from it on a dense block is faster than the entries of sparse matrices."""
TOGETHER = 4
"""Rows of a product taken at a time: amplitudes and forces on them are read a fourth as often. The code below
writes these four rows out."""


class ModalFreedoms(NamedTuple):
    """The last b of n freedoms, from `first` on; b = 0 where there are fewer than `MIN`."""

    first: int
    """Number of the other freedoms, which come before the modal ones."""
    row: IntArray
    """Local coordinates that the modal freedoms move. Their number s is a multiple of `TOGETHER`: the last
    ones repeat. Shape (s,).
    """
    shape: FloatArray
    """Motion of these coordinates per amplitude: a block of `SystemArrays.direction`; 0 where one repeats.
    Shape (s, b).
    """
    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    """`mass`, `damping`, `stiffness`: Diagonals. Shape (b,) each."""


def modal_freedoms_of(
    mass: FloatArray, damping: FloatArray, stiffness: FloatArray, direction: FloatArray, others: FloatArray
) -> ModalFreedoms:
    """Find the modal freedoms of a system with n freedoms.

    Matrices are (n, n); `direction` (R, n) has the motion of local coordinates per freedom. A freedom with an
    entry in `others` (..., n), such as directions of loads and inertial forces, is not modal.
    """
    size, entries = mass.shape[0], (mass != 0.0) | (damping != 0.0) | (stiffness != 0.0)
    coupled_pairs = entries & ~np.eye(size, dtype=bool)
    coupled = np.any(coupled_pairs, axis=1) | np.any(others != 0.0, axis=0)
    first = int(np.max(np.flatnonzero(coupled), initial=-1)) + 1
    if size - first < MIN:
        first = size
    block = direction[:, first:]
    row = np.flatnonzero(np.any(block != 0.0, axis=1))
    missing = -row.size % TOGETHER
    shape = np.concatenate([block[row], np.zeros((missing, size - first))])
    return ModalFreedoms(
        first,
        np.concatenate([row, np.full(missing, row[0] if row.size else 0)]).astype(np.int64),
        np.ascontiguousarray(shape),
        *(np.ascontiguousarray(np.diag(matrix)[first:]) for matrix in (mass, damping, stiffness)),
    )


@inner_sums
def _four_sums(modal: ModalFreedoms, r: int, q: FloatArray) -> tuple[float, float, float, float]:
    """Return four rows of the shape, from `r` on, times the amplitudes in `q` (n,)."""
    # unsigned indices: the compiler then needs no code for negative ones
    a, b, c, d, first = 0.0, 0.0, 0.0, 0.0, np.uint64(modal.first)
    for i in range(np.uint64(modal.damping.size)):
        amplitude = q[first + i]
        a += modal.shape[r, i] * amplitude
        b += modal.shape[r + 1, i] * amplitude
        c += modal.shape[r + 2, i] * amplitude
        d += modal.shape[r + 3, i] * amplitude
    return a, b, c, d


@inner
def add_modal_motion(modal: ModalFreedoms, q: FloatArray, coordinate: FloatArray) -> None:
    """Add the motion by the amplitudes in `q` (n,) to local coordinates (R,); with rates for both, rates."""
    for r in range(0, modal.row.size, TOGETHER):
        a, b, c, d = _four_sums(modal, r, q)
        coordinate[modal.row[r]] += a
        coordinate[modal.row[r + 1]] += b
        coordinate[modal.row[r + 2]] += c
        coordinate[modal.row[r + 3]] += d


@inner_sums
def modal_loss(modal: ModalFreedoms, velocity: FloatArray) -> float:
    """Return the power lost in the modes' own dampers at `velocity` (n,), W."""
    power, first = 0.0, np.uint64(modal.first)
    for i in range(np.uint64(modal.damping.size)):
        power += modal.damping[i] * velocity[first + i] * velocity[first + i]
    return power


@inner
def subtract_modal_resistance(modal: ModalFreedoms, q: FloatArray, v: FloatArray, force: FloatArray) -> None:
    """Subtract the forces of the modes' dampers and springs at `q` and `v` (n,) from `force` (n,)."""
    first = np.uint64(modal.first)
    for i in range(np.uint64(modal.damping.size)):
        force[first + i] -= modal.damping[i] * v[first + i] + modal.stiffness[i] * q[first + i]


@inner
def subtract_modal_forces(modal: ModalFreedoms, local: FloatArray, force: FloatArray) -> None:
    """Subtract the local forces `local` (R,) on the amplitudes from `force` (n,)."""
    first = np.uint64(modal.first)
    for r in range(0, modal.row.size, TOGETHER):
        a, b = local[modal.row[r]], local[modal.row[r + 1]]
        c, d = local[modal.row[r + 2]], local[modal.row[r + 3]]
        for i in range(np.uint64(modal.damping.size)):
            pushed = modal.shape[r, i] * a + modal.shape[r + 1, i] * b
            force[first + i] -= pushed + (modal.shape[r + 2, i] * c + modal.shape[r + 3, i] * d)
