"""Loads that turn from tooth to tooth of a ring, harmonic by harmonic, and the sum of their displacements.

A cut is the face between two neighboring sectors, with nc freedoms. Cuts are scaled such that the stiffness
of a cut against itself is the unit matrix. C is the stiffness between the two cuts of a sector.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.errors import SolveError
from fe_contact.types import ComplexArray, FloatArray
from host.optional_modules import linalg


@dataclass(frozen=True)
class TurningLoads:
    """Loads (2 nc, p) on the scaled cuts of a sector of a ring of `teeth`, that turn from tooth to tooth.

    `across` is C, and q the `spring` (nc, 1) of a stiffness q q' against what all cuts have in common.
    """

    across: FloatArray
    loads: FloatArray
    teeth: int
    spring: FloatArray | None = None

    @property
    def harmonics(self) -> range:
        """Numbers of the harmonics; n and z - n are complex conjugate."""
        return range(self.teeth // 2 + 1)

    def solve(self, number: int) -> ComplexArray:
        """Return the left cut of sector 0 under harmonic `number`, (nc, p).

        Raises `SolveError`: the harmonic is not positive definite.
        """
        phase = np.exp(2j * np.pi * number / self.teeth)
        matrix = np.empty(self.across.shape, dtype=complex, order="F")
        matrix.real = phase.real * (self.across + self.across.T) + np.eye(len(matrix))
        matrix.imag = phase.imag * (self.across.T - self.across)
        if number == 0 and self.spring is not None:
            matrix.real += self.spring @ self.spring.T
        factor, info = linalg.lapack.zpotrf(matrix, lower=1, clean=0, overwrite_a=1)
        if info:
            raise SolveError(f"ring of teeth: harmonic {number} is not positive definite (pivot {info})")
        left, right = np.split(self.loads, 2)
        x = linalg.blas.ztrsm(1.0, factor, np.asfortranarray(left + phase * right), lower=1, overwrite_b=1)
        return np.asarray(linalg.blas.ztrsm(1.0, factor, x, lower=1, trans_a=2, overwrite_b=1))

    def within(self, basis: FloatArray) -> TurningLoads:
        """Return the ring whose cuts move in the space of orthonormal columns `basis` (nc, k) only."""
        loads = np.concatenate([basis.T @ part for part in np.split(self.loads, 2)])
        spring = None if self.spring is None else basis.T @ self.spring
        return replace(self, across=basis.T @ (self.across @ basis), loads=loads, spring=spring)


def weights(teeth: int) -> FloatArray:
    """Return the weight of each harmonic of a load on one tooth, with that of its conjugate."""
    numbers = np.arange(teeth // 2 + 1)
    return np.where((numbers == 0) | (2 * numbers == teeth), 1.0, 2.0) / teeth


@dataclass(frozen=True)
class LeftCuts:
    """Left cuts under many loads on tooth 0: near it for the first ones, in all sectors for the others."""

    near: dict[int, FloatArray]
    everywhere: FloatArray


def left_cuts(solutions: Iterable[ComplexArray], teeth: int, reach: int, first: int) -> LeftCuts:
    """Sum up the harmonics of the left cuts.

    Parameters
    ----------
    solutions : iterable of (nc, p) array
        Left cut of sector 0 under loads that turn from tooth to tooth, by harmonic.
    teeth, reach : int
        Number of teeth of the ring, and largest distance of teeth whose displacements are wanted.
    first : int
        Number of loads that only the sectors -reach - 1 .. reach are wanted for.
    """
    near: dict[int, FloatArray] = {}
    waves = []
    for n, (solution, weight) in enumerate(zip(solutions, weights(teeth), strict=True)):
        x = weight * solution
        waves.append(x[:, first:])
        for j in range(-reach - 1, reach + 1):
            phase = np.exp(2j * np.pi * n * j / teeth)
            near[j] = near.get(j, 0.0) + phase.real * x.real[:, :first] - phase.imag * x.imag[:, :first]
    turns = np.exp(2j * np.pi / teeth * np.outer(np.arange(teeth), np.arange(len(waves))))
    return LeftCuts(near, np.tensordot(turns, np.stack(waves), axes=1).real)
