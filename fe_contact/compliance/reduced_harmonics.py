"""A ring of teeth whose cuts move in the space of a few solved harmonics, as many as residuals ask for."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import blas, lapack

from fe_contact.compliance.cyclic_harmonics import TurningLoads, weights
from fe_contact.types import ComplexArray, FloatArray
from model_studies.progress import Report

# Shares of the largest entry of A:
MIN_SIGNIFICANT = 1e-12  # compliance by what flank loads pass to the cuts that is told from rounding
MIN_PASSED = 1e-7  # the same that is solved for where not every harmonic is
MIN_ENERGY = 1e-8  # energy under unit loads that a direction of the space holds
LARGEST_ERROR = 3e-7  # what a flank node may be off by harmonics that are not solved

SOFTENED = 2.0  # what moving neighbors add to the compliance of a cut; where it is more, the space holds it
RESOLVED = 1e-10  # of the largest energy among vectors: the least that their products show
SKETCH = 16  # random sums that tell the size of what is unbalanced


def first_harmonics(teeth: int) -> list[int]:
    """Return the harmonics that are solved first: even steps of the logarithm from 2 on; all of few teeth."""
    spread = (round(2.0 * (teeth / 4.0) ** (i / 3.0)) for i in range(4))
    return sorted({min(number, teeth // 2) for number in (0, 1, *spread)})


def least_passed(teeth: int) -> float:
    """Return the share of the compliance from which loads count as different; more with all harmonics."""
    return MIN_SIGNIFICANT if len(first_harmonics(teeth)) > teeth // 2 else MIN_PASSED


class ClosedRing(NamedTuple):
    """All harmonics in the space of `basis` (nc, k), as `left_cuts` takes them.

    `solved` (z, nc, p) are scaled left cuts under some loads, of which `shares` (z,) act on each tooth so
    that solved harmonics alone appear; `error` is what a flank node is off, estimated, m/N.
    """

    basis: FloatArray
    solutions: list[ComplexArray]
    solved: FloatArray
    shares: FloatArray
    error: float


def solve_few(
    ring: TurningLoads,
    basis: FloatArray,
    modes: FloatArray,
    largest: float,
    probes: slice,
    report: Report,
) -> ClosedRing:
    """Solve a few harmonics and as many more as residuals ask for, the others in the space of these.

    Parameters
    ----------
    basis : (nc, k) array
        What the space holds to begin with.
    modes : (nf, r) array
        Flank loads that the first columns of the loads stand for.
    largest : float
        That the limits are shares of, m/N.
    probes : slice
        Columns of the loads that `solved` is wanted for.
    """
    known: dict[int, ComplexArray] = {}
    chosen = first_harmonics(ring.teeth)
    direct = len(chosen) == len(ring.harmonics)
    while not direct:
        for number in chosen:
            x = ring.solve(number)
            known[number] = x[:, probes]
            basis = _extended(basis, np.concatenate([x.real, x.imag], axis=1), MIN_ENERGY * largest)
            report(len(known) / (len(known) + 2.0))
        within = ring.within(basis)
        solutions = [within.solve(number) for number in ring.harmonics]
        residual = _residual_energy(ring, basis, solutions, modes)
        if residual.sum(axis=0).max() <= LARGEST_ERROR * largest:
            break
        chosen = [int(residual.max(axis=1).argmax())]
        # as large as the problem, or rounding alone is left
        direct = 4 * basis.shape[1] > 3 * len(basis) or chosen[0] in known
    if direct:
        solutions = [ring.solve(number) for number in ring.harmonics]
        known = {number: x[:, probes] for number, x in enumerate(solutions)}
        basis, residual = np.eye(len(basis)), np.zeros((1, 1))
    parts = weights(ring.teeth)[list(known)]
    parts /= parts.sum()
    turns = np.exp(2j * np.pi / ring.teeth * np.outer(np.arange(ring.teeth), list(known)))
    solved = np.tensordot(parts * turns, np.stack(list(known.values())), axes=1).real
    return ClosedRing(basis, solutions, solved, turns.real @ parts, float(residual.sum(axis=0).max()))


def _extended(basis: FloatArray, columns: FloatArray, minimum: float) -> FloatArray:
    """Return orthonormal columns that also span `columns` (nc, p), but for directions of less energy.

    The softest come first: beside them rounding hides the stiff ones.
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

    That is told by the squares of `SKETCH` sums of all forces with random signs.
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
    """Return orthonormal columns (nf, r) that span the rows of a matrix but for squares below `minimum`."""
    vectors, values = _whitening(_gram(matrix), minimum)
    return vectors * np.sqrt(values)


def _gram(columns: FloatArray) -> FloatArray:
    """Return X'X, lower triangle."""
    return np.asarray(blas.dsyrk(1.0, np.asfortranarray(columns), trans=1, lower=1))


def _whitening(gram: FloatArray, minimum: float) -> tuple[FloatArray, FloatArray]:
    """Return T (p, k) with T' G T = 1 and the k eigenvalues above `minimum` of a Gram matrix, lower triangle.

    They are those of its pivoted factor, which ends when no diagonal entry above `minimum` is left.
    """
    factor, pivots, rank, _ = lapack.dpstrf(np.asfortranarray(gram), lower=1, tol=minimum)
    lower = np.tril(factor[:, :rank])
    values, vectors = np.linalg.eigh(lower.T @ lower)
    significant = values > minimum
    whitening = np.empty((len(gram), int(significant.sum())))
    whitening[pivots - 1] = lower @ (vectors[:, significant] / values[significant])
    return whitening, values[significant]
