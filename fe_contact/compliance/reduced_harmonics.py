"""A ring of teeth whose cuts move in the space of a few solved harmonics.

A sector is the part of a gear with one tooth, a cut its face to the next sector. Loads turn from tooth to
tooth by harmonics (`cyclic_harmonics`). A few harmonics are solved exactly; their solutions span a space in
which the others are solved (Galerkin). Forces that stay unbalanced, the residuals, tell whether a further
harmonic is solved too. Cuts are scaled so that squares of displacements and of forces are energies; see
`cyclic_ring`.

Shapes: z teeth, nc freedoms of a cut, nf flank freedoms, k columns of the basis, p loads. A is the compliance
of the flank with the cuts held.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fe_contact.compliance.cyclic_harmonics import TurningLoads, weights
from fe_contact.types import ComplexArray, FloatArray
from host.optional_modules import linalg
from model_studies.progress import Report

MIN_SIGNIFICANT = 1e-12
"""Share of A's largest entry below which the compliance by forces on the cuts, passed on by flank loads, is
rounding.
"""
MIN_PASSED = 1e-7
"""Share of A's largest entry below which this compliance is left out, where not every harmonic is solved."""
MIN_ENERGY = 1e-8
"""Share of A's largest entry: energy under unit loads below which a direction is left out of the space."""
LARGEST_ERROR = 3e-7
"""Share of A's largest entry: allowed error of a flank node by the harmonics that are not solved."""

SOFTENED = 2.0
"""Factor of a cut's compliance for neighbors that move; softer directions are in the space anyway."""
RESOLVED = 1e-10
"""Share of the largest energy among vectors below which their scalar products show rounding only."""
SKETCH = 16
"""Number of random sums of the unbalanced forces, by which the size of these is estimated."""


def first_harmonics(teeth: int) -> list[int]:
    """Return the harmonics that are solved first: 0, 1, and four from 2 to z/2, evenly by the logarithm.

    For few teeth these are all harmonics.
    """
    spread = (round(2.0 * (teeth / 4.0) ** (i / 3.0)) for i in range(4))
    return sorted({min(number, teeth // 2) for number in (0, 1, *spread)})


def least_passed(teeth: int) -> float:
    """Return the share of the compliance from which loads are solved for: less with all harmonics."""
    return MIN_SIGNIFICANT if len(first_harmonics(teeth)) > teeth // 2 else MIN_PASSED


class ClosedRing(NamedTuple):
    """Motions of the cuts by harmonic, in the space of a basis."""

    basis: FloatArray
    """Orthonormal columns of the space. Shape (nc, k)."""
    solutions: list[ComplexArray]
    """Left cut of sector 0 by harmonic, as `left_cuts` takes them. Shape (k, p) each."""
    solved: FloatArray
    """Left cut of each sector under the probe loads times `shares`, in which exactly solved harmonics alone
    appear. Shape (z, nc, p).
    """
    shares: FloatArray
    """Factor of the probe loads on each tooth for `solved`. Shape (z,)."""
    error: float
    """Estimated error of a flank node, m/N."""


def solve_few(
    ring: TurningLoads,
    basis: FloatArray,
    modes: FloatArray,
    largest: float,
    probes: slice,
    report: Report,
) -> ClosedRing:
    """Solve as many harmonics as residuals require, and the others in the space of their solutions.

    Parameters
    ----------
    basis : (nc, k) array
        Columns with which the space begins.
    modes : (nf, r) array
        Flank loads of the first r columns of the ring's loads.
    largest : float
        Largest entry of A, of which the limits are shares, m/N.
    probes : slice
        Columns of the ring's loads that are the probe loads of `ClosedRing.solved`.
    """
    known: dict[int, ComplexArray] = {}
    chosen = first_harmonics(ring.teeth)
    direct = len(chosen) == len(ring.harmonics)
    while not direct:
        for number in chosen:
            x = ring.solve(number)
            known[number] = x[:, probes]
            basis = _extended(basis, np.concatenate([x.real, x.imag], axis=1), MIN_ENERGY * largest)
            report(len(known) / (len(known) + 2.0))  # as if two more harmonics were needed
        within = ring.within(basis)
        solutions = [within.solve(number) for number in ring.harmonics]
        residual = _residual_energy(ring, basis, solutions, modes)
        if residual.sum(axis=0).max() <= LARGEST_ERROR * largest:
            break
        chosen = [int(residual.max(axis=1).argmax())]
        # solve all harmonics if the space is nearly as large as the problem, or rounding alone is left
        direct = 4 * basis.shape[1] > 3 * len(basis) or chosen[0] in known
    if direct:
        solutions = [ring.solve(number) for number in ring.harmonics]
        known = {number: x[:, probes] for number, x in enumerate(solutions)}
        basis, residual = np.eye(len(basis)), np.zeros((1, 1))
    parts = weights(ring.teeth)[list(known)]
    parts /= parts.sum()
    turns = np.exp(2j * np.pi / ring.teeth * np.outer(np.arange(ring.teeth), list(known)))
    solved = np.tensordot(parts * turns, np.stack(list(known.values())), axes=1).real
    return ClosedRing(
        basis=basis,
        solutions=solutions,
        solved=solved,
        shares=turns.real @ parts,
        error=float(residual.sum(axis=0).max()),
    )


def _extended(basis: FloatArray, columns: FloatArray, minimum: float) -> FloatArray:
    """Return orthonormal columns that also span `columns` (nc, p), but for directions of less than `minimum`.

    The directions of largest energy are added first, since rounding of their products hides the stiff ones;
    the rest follow in further passes.
    """
    while True:
        columns = columns - basis @ (basis.T @ columns)
        gram = _gram(columns)
        largest = gram.diagonal().max()
        if largest <= minimum:
            return basis
        added = columns @ _whitening(gram, max(minimum, RESOLVED * largest))[0]
        added -= basis @ (basis.T @ added)
        basis = np.concatenate([basis, added @ _whitening(_gram(added), 0.5)[0]], axis=1)


def _residual_energy(
    ring: TurningLoads, basis: FloatArray, solutions: list[ComplexArray], modes: FloatArray
) -> FloatArray:
    """Return the energy of the unbalanced forces under unit load, by harmonic and flank node or other load.

    It is estimated by the squares of `SKETCH` sums of all forces with random signs, whose mean it is.
    """
    signs = np.random.default_rng(0).choice([-1.0, 1.0], size=(SKETCH, len(basis))) / np.sqrt(SKETCH)
    left, right = (signs @ part for part in np.split(ring.loads, 2))
    within, behind, ahead = signs @ basis, signs @ ring.across @ basis, signs @ ring.across.T @ basis
    rank, residuals = modes.shape[1], []
    for number, (x, weight) in enumerate(zip(solutions, weights(ring.teeth), strict=True)):
        phase_factor = np.exp(2j * np.pi * number / ring.teeth)
        out = left + phase_factor * right - (within + phase_factor.conj() * behind + phase_factor * ahead) @ x
        if number == 0 and ring.spring is not None:
            out -= (signs @ ring.spring) @ (ring.spring.T @ basis @ x)
        out = np.concatenate([out[:, :rank] @ modes.T, out[:, rank:]], axis=1)
        residuals.append(weight * (out.real**2 + out.imag**2).sum(axis=0))
    return np.stack(residuals)


def row_space(matrix: FloatArray, minimum: float) -> FloatArray:
    """Return orthonormal columns (nf, r) that span the rows of a matrix, but for squares below `minimum`."""
    vectors, values = _whitening(_gram(matrix), minimum)
    return vectors * np.sqrt(values)


def _gram(columns: FloatArray) -> FloatArray:
    """Return X'X, lower triangle."""
    return np.asarray(linalg.blas.dsyrk(1.0, np.asfortranarray(columns), trans=1, lower=1))


def _whitening(gram: FloatArray, minimum: float) -> tuple[FloatArray, FloatArray]:
    """Return T (p, k) with T' G T = 1 and the k eigenvalues above `minimum` of a Gram matrix, lower triangle.

    The eigenvalues are computed from its pivoted Cholesky factor, which ends when no diagonal entry above
    `minimum` is left.
    """
    factor, pivots, rank, _ = linalg.lapack.dpstrf(np.asfortranarray(gram), lower=1, tol=minimum)
    lower = np.tril(factor[:, :rank])
    values, vectors = np.linalg.eigh(lower.T @ lower)
    significant = values > minimum
    whitening = np.empty((len(gram), int(significant.sum())))
    # LAPACK counts from 1
    whitening[pivots - 1] = lower @ (vectors[:, significant] / values[significant])
    return whitening, values[significant]
