"""The closed ring of z identical condensed sectors, by cyclic harmonics.

Sector j + 1 follows sector j counter-clockwise; the left cut of one is the right cut of the next. A load on
tooth 0 alone is the mean over harmonics n of loads that turn by w = 2 pi n / z from tooth to tooth; with the
phase e^(iwj) on sector j one sector closes on itself, left cut x, right cut e^(-iw) x:

    D_n x = (B_l + e^(iw) B_r) f,    D_n = K_ll + K_rr + e^(-iw) K_lr + e^(iw) K_rl,

K condensed on the cuts and B the force that flank loads pass to held cuts. With G_m the map from such forces
on sector 0 to the cuts of sector m, which the harmonics sum up to, the flank of tooth m moves by

    S_m = delta_m0 A + B' G_m B,    S_-m = S_m',

A the compliance with the cuts held. Far from the flank a load is known by few numbers: with V the leading
singular directions of B, P = V V' and T_m = B' G_m B V,

    B' G_m B = T_m V' + V T_-m' - V V' T_m V'    but for (1 - P) B' G_m B (1 - P),

so a singular value dropped counts by its square, and only the columns of V need solving.

Thomas, D. L. (1979). Dynamics of rotationally periodic structures. Int. J. Numer. Meth. Engng 14, 81-102.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import blas, lapack

from fe_contact.errors import SolveError
from fe_contact.types import FloatArray, IntArray
from model_studies.progress import Report, unreported

ComplexArray = NDArray[np.complex128]
Scalar = TypeVar("Scalar", np.float64, np.complex128)
RANK_TOLERANCE = 1e-6  # least over largest singular value of B that is kept; what is lost is its square


@dataclass(frozen=True)
class HeldSector:
    """A sector whose flank freedoms are eliminated.

    Attributes
    ----------
    flank : (nf, nf) array
        A: flank displacement per flank force, cuts held, m/N.
    transmitted : (2 nc, nf) array
        B: force on the cuts per flank force, cuts held; also (transposed) flank displacement per displacement
        of the cuts. Left cut first.
    cuts : (2 nc, 2 nc) array
        K: stiffness condensed on the cuts, N/m.
    """

    flank: FloatArray
    transmitted: FloatArray
    cuts: FloatArray

    @property
    def cut_size(self) -> int:
        """Number of freedoms of one cut."""
        return len(self.cuts) // 2


@dataclass(frozen=True)
class RingSolution:
    """Flank compliance of the ring, and the cuts under probe loads.

    Attributes
    ----------
    blocks : (reach + 1, nf, nf) array
        S_m: displacement of the flank of tooth m per force on the flank of tooth 0, m/N.
    left : (z, nc, p) array
        Displacement of the left cut of every sector under the probe loads on tooth 0, m.
    rank : int
        Numerical rank of what flank loads pass to the cuts.
    bore : (z, nc, p) array
        Displacement of the left cut of every sector under unit forces on the bore of sector 0, where it is
        free to turn, m/N.
    turn : (nc,) array
        Displacement of a cut under a unit turn of the gear, where it is free to turn, m.
    restraint : float
        Stiffness against the mean turn of the cuts, N/m per m: force on each left cut is ``turn`` times
        ``restraint`` times ``turn`` times its mean displacement.
    """

    blocks: FloatArray
    left: FloatArray
    rank: int
    bore: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))
    turn: FloatArray = field(default_factory=lambda: np.zeros(0))
    restraint: float = 0.0

    @property
    def restraining(self) -> FloatArray:
        """Forces that restrain the mean turn on each left cut under the probe loads, (nc, p), N."""
        if not self.restraint:
            return np.zeros(self.left.shape[1:])
        mean = self.left.mean(axis=0)
        return np.outer(self.restraint * self.turn, self.turn @ mean)

    @property
    def right(self) -> FloatArray:
        """Displacement of the right cuts: the left ones of the sectors before."""
        return np.roll(self.left, 1, axis=0)


@dataclass(frozen=True)
class FreeTurn:
    """A gear that nothing in its sectors keeps from turning.

    Attributes
    ----------
    turn : (nc,) array
        Displacement of a cut under a unit turn, m.
    flank : int
        Number of flank freedoms; the other loaded ones are on the bore.
    key_cut : int array
        Freedoms of a cut that are on the bore and may be loaded.
    """

    turn: FloatArray
    flank: int
    key_cut: IntArray


def hold_sector(matrix: FloatArray, flank: int) -> HeldSector:
    """Eliminate the first `flank` freedoms of a condensed stiffness, whose lower triangle is given.

    Raises
    ------
    SolveError
        The flank block is not positive definite.
    """
    factor, info = lapack.dpotrf(np.asfortranarray(matrix[:flank, :flank]), lower=1, clean=1)
    if info:
        raise SolveError(f"tooth sector: flank stiffness is not positive definite (pivot {info})")
    below = np.asfortranarray(matrix[flank:, :flank])
    coupling = blas.dtrsm(1.0, factor, below, side=1, lower=1, trans_a=1)
    rest = np.asfortranarray(matrix[flank:, flank:])
    cuts = blas.dsyrk(-1.0, coupling, beta=1.0, c=rest, lower=1, overwrite_c=1)
    # Minus: a force on the flank and the force it needs on held cuts point the other way.
    transmitted = blas.dtrsm(-1.0, factor, coupling, side=1, lower=1)
    inverse, _ = lapack.dpotri(factor, lower=1)
    return HeldSector(_full(inverse), transmitted, _full(cuts))


def close_ring(
    held: HeldSector,
    teeth: int,
    reach: int,
    probes: FloatArray,
    free: FreeTurn | None = None,
    report: Report = unreported,
) -> RingSolution:
    """Join `teeth` copies of a sector.

    Parameters
    ----------
    teeth : int
        z.
    reach : int
        Largest distance m in teeth for which S_m is wanted.
    probes : (nf, p) array
        Flank loads on tooth 0 for which all cuts are wanted, N.
    free : FreeTurn, optional
        The ring may turn: its mean turn is restrained, and unit forces on the bore are answered too.
    report : callable
        Called after each harmonic with the fraction of them done.

    Raises
    ------
    SolveError
        A harmonic is not positive definite.
    """
    modes = row_space(held.transmitted)
    size, rank = held.cut_size, modes.shape[1]
    loads, count = held.transmitted @ np.concatenate([modes, probes], axis=1), probes.shape[1]
    restraint = 0.0
    if free is not None:
        on_cut = np.eye(2 * size)[:, free.key_cut]
        loads = np.concatenate([loads, held.transmitted[:, free.flank :], on_cut], axis=1)
        restraint = float(np.trace(held.cuts) / (free.turn @ free.turn))
    spring = None if free is None else np.sqrt(restraint) * free.turn
    cuts = left_cuts(held, loads, teeth, reach, rank, spring, report)
    blocks = np.empty((reach + 1, len(modes), len(modes)))
    moved = {
        m: held.transmitted[:size].T @ cuts.near[m] + held.transmitted[size:].T @ cuts.near[m - 1]
        for m in range(-reach, reach + 1)
    }
    for m in range(reach + 1):
        ahead = moved[m] - modes @ (modes.T @ moved[m])
        blocks[m] = ahead @ modes.T + modes @ moved[-m].T
    blocks[0] += held.flank
    if free is None:
        return RingSolution(blocks, cuts.everywhere, rank)
    left, bore = cuts.everywhere[..., :count], cuts.everywhere[..., count:]
    return RingSolution(blocks, left, rank, bore, free.turn, restraint)


@dataclass(frozen=True)
class LeftCuts:
    """Left cuts under many loads on tooth 0: near it for the first ones, in all sectors for the others."""

    near: dict[int, FloatArray]
    everywhere: FloatArray


def left_cuts(
    held: HeldSector,
    loads: FloatArray,
    teeth: int,
    reach: int,
    first: int,
    spring: FloatArray | None = None,
    report: Report = unreported,
) -> LeftCuts:
    """Sum up the harmonics of the left cuts.

    Parameters
    ----------
    loads : (2 nc, p) array
        On the cuts of sector 0.
    teeth, reach : int
        See `close_ring`.
    first : int
        Number of loads that only the sectors -reach - 1 .. reach are wanted for.
    spring : (nc,) array, optional
        q of the stiffness q q' that restrains what all cuts have in common.
    report : callable
        Called after each harmonic with the fraction of them done.

    Raises
    ------
    SolveError
        A harmonic is not positive definite.
    """
    size = held.cut_size
    near = {j: np.zeros((size, first)) for j in range(-reach - 1, reach + 1)}
    angles = 2.0 * np.pi / teeth * np.arange(teeth // 2 + 1)
    waves = np.empty((len(angles), size, loads.shape[1] - first), dtype=complex)
    for n, angle in enumerate(angles):
        # Harmonics n and z - n are complex conjugate.
        weight = (1.0 if n == 0 or 2 * n == teeth else 2.0) / teeth
        factor = _harmonic_factor(held.cuts, float(angle), n, spring)
        x = np.asfortranarray(weight * (loads[:size] + np.exp(1j * angle) * loads[size:]))
        x = blas.ztrsm(1.0, factor, x, lower=1, overwrite_b=1)
        x = blas.ztrsm(1.0, factor, x, lower=1, trans_a=2, overwrite_b=1)
        waves[n] = x[:, first:]
        real, imaginary = x.real[:, :first], x.imag[:, :first]
        for j in near:
            near[j] += np.cos(angle * j) * real - np.sin(angle * j) * imaginary
        report((n + 1) / len(angles))
    turns = np.exp(1j * np.outer(np.arange(teeth), angles))
    return LeftCuts(near, np.tensordot(turns, waves, axes=1).real)


def _harmonic_factor(cuts: FloatArray, angle: float, number: int, spring: FloatArray | None) -> ComplexArray:
    """Return the Cholesky factor of one sector closed on itself with the phase `angle`."""
    size = len(cuts) // 2
    across = cuts[:size, size:]
    matrix = np.empty((size, size), dtype=complex, order="F")
    matrix.real = cuts[:size, :size] + cuts[size:, size:] + np.cos(angle) * (across + across.T)
    matrix.imag = np.sin(angle) * (across.T - across)
    if number == 0 and spring is not None:
        matrix.real += np.outer(spring, spring)
    factor, info = lapack.zpotrf(matrix, lower=1, clean=0, overwrite_a=1)
    if info:
        raise SolveError(f"ring of teeth: harmonic {number} is not positive definite (pivot {info})")
    return np.asarray(factor)


def row_space(matrix: FloatArray) -> FloatArray:
    """Return orthonormal columns (nf, r) that span the rows of `matrix` (2 nc, nf) to `RANK_TOLERANCE`."""
    squares, vectors = np.linalg.eigh(matrix.T @ matrix)
    return np.asarray(vectors[:, squares > RANK_TOLERANCE**2 * squares[-1]])


def _full(lower: NDArray[Scalar]) -> NDArray[Scalar]:
    """Return the Hermitian matrix of a lower triangle; whatever is above the diagonal is ignored."""
    part = np.tril(lower)
    return part + np.tril(part, -1).conj().T
