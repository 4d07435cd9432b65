"""The closed ring of z identical condensed sectors, by cyclic harmonics on a reduced basis.

Sector j + 1 follows sector j counter-clockwise; the left cut of one is the right cut of the next. A load on
tooth 0 alone is the mean over harmonics n of loads that turn by w = 2 pi n / z from tooth to tooth; with the
phase e^(iwj) on sector j one sector closes on itself, left cut x, right cut e^(-iw) x:

    D_n x = (B_l + e^(iw) B_r) f,    D_n = K_ll + K_rr + e^(-iw) K_lr + e^(iw) K_rl,

K condensed on the cuts and B the force that flank loads pass to held cuts. With G_m the map from such forces
on sector 0 to the cuts of sector m, which the harmonics sum up to, the flank of tooth m moves by

    S_m = delta_m0 A + B' G_m B,    S_-m = S_m',

A the compliance with the cuts held. The cuts are scaled to K_ll + K_rr = 1, L L' before: squares of scaled
forces and displacements are then energies, and a force r that is not balanced is worth r'r of compliance but
for the factor by which neighbors soften a cut. Three errors enter S by their squares:

- Loads V are solved for, and what passes less than `LEAST_PASSED` to the cuts is not. With P = V V' and
  T_m = B' G_m B V,  B' G_m B = T_m V' + V T_-m' - V V' T_m V'  but for  (1 - P) B' G_m B (1 - P).
- A few harmonics are solved; the others by Galerkin's method in the space of these solutions.
- Directions that hold less than `LEAST_ENERGY` of the solutions are left out of it.

What the last two leave unbalanced is measured at every harmonic, and where a flank node is more than
`LARGEST_MISSED` off, the worst harmonic is solved, too.

Thomas, D. L. (1979). Dynamics of rotationally periodic structures. Int. J. Numer. Meth. Engng 14, 81-102.
Quarteroni, A., Manzoni, A., Negri, F. (2016). Reduced basis methods for partial differential equations.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import blas, lapack

from fe_contact.errors import SolveError
from fe_contact.types import FloatArray, IntArray
from model_studies.progress import Report, unreported

ComplexArray = NDArray[np.complex128]
Scalar = TypeVar("Scalar", np.float64, np.complex128)
# Shares of the largest entry of A:
LEAST_TOLD = 1e-12  # compliance by what flank loads pass to the cuts that is told from rounding
LEAST_PASSED = 1e-7  # the same that is solved for where not every harmonic is
LEAST_ENERGY = 1e-8  # energy under unit loads that a direction of the space holds
LARGEST_MISSED = 3e-7  # what a flank node may be off by harmonics that are not solved

SOFTENED = 2.0  # what moving neighbors add to the compliance of a cut; where it is more, the space holds it
RESOLVED = 1e-10  # of the largest energy among vectors: the least that their products show
SKETCH = 16  # random sums that tell the size of what is unbalanced


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
class EvenSector:
    """A held sector whose cuts are scaled: K_ll + K_rr = L L' becomes 1.

    Attributes
    ----------
    transmitted : (2 nc, nf) array
        L^-1 B_l and L^-1 B_r.
    across : (nc, nc) array
        C = L^-1 K_lr L^-T: force on the left cut per displacement of the right one.
    scale : (nc, nc) array
        L, lower triangle.
    """

    transmitted: FloatArray
    across: FloatArray
    scale: FloatArray

    def force(self, forces: FloatArray) -> FloatArray:
        """Return scaled forces L^-1 f of forces (nc, p) on a cut."""
        return np.asarray(blas.dtrsm(1.0, self.scale, np.asfortranarray(forces), lower=1))

    def displacement(self, scaled: FloatArray) -> FloatArray:
        """Return the displacement L^-T x of a cut from the scaled one, (nc, p)."""
        return np.asarray(blas.dtrsm(1.0, self.scale, np.asfortranarray(scaled), lower=1, trans_a=1))


@dataclass(frozen=True)
class RingSolution:
    """Flank compliance of the ring, and the cuts under probe loads.

    Attributes
    ----------
    blocks : (reach + 1, nf, nf) array
        S_m: displacement of the flank of tooth m per force on the flank of tooth 0, m/N.
    left : (z, nc, p) array
        Displacement of every left cut under the probe loads on tooth 0, m; its energy is exact as `blocks`.
    shares : (z,) array
        Shares of the probe loads on each tooth that add up to a load of solved harmonics alone; 1 on tooth 0.
    solved : (z, nc, p) array
        Displacement of the left cuts under these, m, but for rounding.
    error : float
        What `blocks` may be off, over the largest entry of A; estimated.
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
    shares: FloatArray = field(default_factory=lambda: np.zeros(0))
    solved: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))
    error: float = 0.0
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


def even_sector(held: HeldSector) -> EvenSector:
    """Scale the cuts of a sector; SolveError if one between two held ones is not stiff in all directions."""
    size = held.cut_size
    own = held.cuts[:size, :size] + held.cuts[size:, size:]
    scale, info = lapack.dpotrf(np.asfortranarray(own), lower=1, clean=1, overwrite_a=1)
    if info:
        raise SolveError(f"ring of teeth: the stiffness of a cut is not positive definite (pivot {info})")
    even = EvenSector(held.transmitted, held.cuts[:size, size:], scale)
    across = blas.dtrsm(1.0, scale, even.force(even.across), side=1, lower=1, trans_a=1, overwrite_b=1)
    transmitted = np.concatenate([even.force(part) for part in np.split(held.transmitted, 2)])
    return EvenSector(transmitted, across, scale)


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
        Called after each solved harmonic with the fraction of them done.

    Raises
    ------
    SolveError
        A harmonic is not positive definite.
    """
    even, count = even_sector(held), probes.shape[1]
    size, flank = held.cut_size, len(held.flank) if free is None else free.flank
    largest = float(np.abs(held.flank[:flank, :flank]).max())
    # Even steps of the logarithm from 2 on; of few teeth these are all.
    spread = (round(2.0 * (teeth / 4.0) ** (i / 3.0)) for i in range(4))
    chosen = sorted({min(number, teeth // 2) for number in (0, 1, *spread)})
    least = LEAST_TOLD if len(chosen) > teeth // 2 else LEAST_PASSED
    # The probes are among them: blocks hold their energy but for rounding.
    modes, _ = np.linalg.qr(np.concatenate([probes, row_space(even.transmitted, least * largest)], axis=1))
    loads, rank = even.transmitted @ np.concatenate([modes, probes], axis=1), modes.shape[1]
    basis, restraint, spring = np.empty((size, 0)), 0.0, None
    if free is not None:
        on_cut = np.zeros((2 * size, len(free.key_cut)))
        on_cut[:size] = even.force(np.eye(size)[:, free.key_cut])
        loads = np.concatenate([loads, even.transmitted[:, free.flank :], on_cut], axis=1)
        restraint = float(np.trace(held.cuts) / (free.turn @ free.turn))
        spring = np.sqrt(restraint) * even.force(free.turn[:, None])
        basis = even.scale.T @ free.turn[:, None]
        basis /= np.linalg.norm(basis)
    ring = TurningLoads(even.across, loads, teeth, spring)
    closed = _closed(ring, basis, modes, largest, chosen, slice(rank, rank + count), report)
    within = np.concatenate([closed.basis.T @ part for part in np.split(even.transmitted, 2)])
    blocks = np.empty((reach + 1, len(modes), len(modes)))
    cuts = left_cuts(closed.solutions, teeth, reach, rank)
    near = {m: np.concatenate([cuts.near[m], cuts.near[m - 1]]) for m in range(-reach, reach + 1)}
    moved = {m: within.T @ near[m] for m in near}
    for m in range(reach + 1):
        ahead = moved[m] - modes @ (modes.T @ moved[m])
        blocks[m] = ahead @ modes.T + modes @ moved[-m].T
    blocks[0] += held.flank
    everywhere = even.displacement(closed.basis) @ cuts.everywhere
    solved = np.stack([even.displacement(left) for left in closed.solved])
    return RingSolution(
        blocks,
        everywhere[..., :count],
        closed.shares,
        solved,
        SOFTENED * (closed.missed / largest + 2.0 * least),
        everywhere[..., count:],
        np.zeros(0) if free is None else free.turn,
        restraint,
    )


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

        Raises
        ------
        SolveError
            The harmonic is not positive definite.
        """
        turn = np.exp(2j * np.pi * number / self.teeth)
        matrix = np.empty(self.across.shape, dtype=complex, order="F")
        matrix.real = turn.real * (self.across + self.across.T) + np.eye(len(matrix))
        matrix.imag = turn.imag * (self.across.T - self.across)
        if number == 0 and self.spring is not None:
            matrix.real += self.spring @ self.spring.T
        factor, info = lapack.zpotrf(matrix, lower=1, clean=0, overwrite_a=1)
        if info:
            raise SolveError(f"ring of teeth: harmonic {number} is not positive definite (pivot {info})")
        left, right = np.split(self.loads, 2)
        x = blas.ztrsm(1.0, factor, np.asfortranarray(left + turn * right), lower=1, overwrite_b=1)
        return np.asarray(blas.ztrsm(1.0, factor, x, lower=1, trans_a=2, overwrite_b=1))

    def within(self, basis: FloatArray) -> TurningLoads:
        """Return the ring whose cuts move in the space of orthonormal columns `basis` (nc, k) only."""
        loads = np.concatenate([basis.T @ part for part in np.split(self.loads, 2)])
        spring = None if self.spring is None else basis.T @ self.spring
        return replace(self, across=basis.T @ (self.across @ basis), loads=loads, spring=spring)


class _Closed(NamedTuple):
    """All harmonics in the space of `basis` (nc, k), as `left_cuts` takes them.

    `solved` (z, nc, p) are scaled left cuts under some loads, of which `shares` (z,) act on each tooth so
    that solved harmonics alone appear; `missed` is what a flank node is off, estimated, m/N.
    """

    basis: FloatArray
    solutions: list[ComplexArray]
    solved: FloatArray
    shares: FloatArray
    missed: float


def _closed(
    ring: TurningLoads,
    basis: FloatArray,
    modes: FloatArray,
    largest: float,
    chosen: list[int],
    probes: slice,
    report: Report,
) -> _Closed:
    """Solve the harmonics `chosen` and as many more as are asked for, the others in the space of these.

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
    direct = len(chosen) == len(ring.harmonics)
    while not direct:
        for number in chosen:
            x = ring.solve(number)
            known[number] = x[:, probes]
            basis = _extended(basis, np.concatenate([x.real, x.imag], axis=1), LEAST_ENERGY * largest)
            report(len(known) / (len(known) + 2.0))
        within = ring.within(basis)
        solutions = [within.solve(number) for number in ring.harmonics]
        missed = _missed(ring, basis, solutions, modes)
        if missed.sum(axis=0).max() <= LARGEST_MISSED * largest:
            break
        chosen = [int(missed.max(axis=1).argmax())]
        # as large as the problem, or rounding alone is left
        direct = 4 * basis.shape[1] > 3 * len(basis) or chosen[0] in known
    if direct:
        solutions = [ring.solve(number) for number in ring.harmonics]
        known = {number: x[:, probes] for number, x in enumerate(solutions)}
        basis, missed = np.eye(len(basis)), np.zeros((1, 1))
    weights = _weights(ring.teeth)[list(known)]
    weights /= weights.sum()
    turns = np.exp(2j * np.pi / ring.teeth * np.outer(np.arange(ring.teeth), list(known)))
    solved = np.tensordot(weights * turns, np.stack(list(known.values())), axes=1).real
    return _Closed(basis, solutions, solved, turns.real @ weights, float(missed.sum(axis=0).max()))


def _extended(basis: FloatArray, columns: FloatArray, least: float) -> FloatArray:
    """Return orthonormal columns that also span `columns` (nc, p), but for directions of less energy.

    The softest come first: beside them rounding hides the stiff ones.
    """
    while True:
        columns = columns - basis @ (basis.T @ columns)
        gram = _gram(columns)
        most = gram.diagonal().max()
        if most <= least:
            return basis
        added = columns @ _whitening(gram, max(least, RESOLVED * most))[0]
        added -= basis @ (basis.T @ added)
        basis = np.concatenate([basis, added @ _whitening(_gram(added), 0.5)[0]], axis=1)


def _missed(
    ring: TurningLoads, basis: FloatArray, solutions: list[ComplexArray], modes: FloatArray
) -> FloatArray:
    """Return the energy of what is unbalanced under unit load, by harmonic and flank node or other load.

    That is told by the squares of `SKETCH` sums of all forces with random signs.
    """
    signs = np.random.default_rng(0).choice([-1.0, 1.0], size=(SKETCH, len(basis))) / np.sqrt(SKETCH)
    left, right = (signs @ part for part in np.split(ring.loads, 2))
    own, behind, ahead = signs @ basis, signs @ ring.across @ basis, signs @ ring.across.T @ basis
    rank, missed = modes.shape[1], []
    for number, (x, weight) in enumerate(zip(solutions, _weights(ring.teeth), strict=True)):
        turn = np.exp(2j * np.pi * number / ring.teeth)
        out = left + turn * right - (own + turn.conj() * behind + turn * ahead) @ x
        if number == 0 and ring.spring is not None:
            out -= (signs @ ring.spring) @ (ring.spring.T @ basis @ x)
        out = np.concatenate([out[:, :rank] @ modes.T, out[:, rank:]], axis=1)
        missed.append(weight * (out.real**2 + out.imag**2).sum(axis=0))
    return np.stack(missed)


def _weights(teeth: int) -> FloatArray:
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
        See `close_ring`.
    first : int
        Number of loads that only the sectors -reach - 1 .. reach are wanted for.
    """
    near: dict[int, FloatArray] = {}
    waves = []
    for n, (solution, weight) in enumerate(zip(solutions, _weights(teeth), strict=True)):
        x = weight * solution
        waves.append(x[:, first:])
        for j in range(-reach - 1, reach + 1):
            turn = np.exp(2j * np.pi * n * j / teeth)
            near[j] = near.get(j, 0.0) + turn.real * x.real[:, :first] - turn.imag * x.imag[:, :first]
    turns = np.exp(2j * np.pi / teeth * np.outer(np.arange(teeth), np.arange(len(waves))))
    return LeftCuts(near, np.tensordot(turns, np.stack(waves), axes=1).real)


def loaded_cuts(held: HeldSector, loads: FloatArray, teeth: int, reach: int = -1, first: int = 0) -> LeftCuts:
    """Return the left cuts under flank `loads` (nf, p) on tooth 0, every harmonic solved; see `left_cuts`."""
    even = even_sector(held)
    ring = TurningLoads(even.across, even.transmitted @ loads, teeth)
    cuts = left_cuts((ring.solve(number) for number in ring.harmonics), teeth, reach, first)
    near = {j: even.displacement(left) for j, left in cuts.near.items()}
    return LeftCuts(near, np.stack([even.displacement(left) for left in cuts.everywhere]))


def row_space(matrix: FloatArray, least: float) -> FloatArray:
    """Return orthonormal columns (nf, r) that span the rows of a matrix but for squares below `least`."""
    vectors, values = _whitening(_gram(matrix), least)
    return vectors * np.sqrt(values)


def _gram(columns: FloatArray) -> FloatArray:
    """Return X'X, lower triangle."""
    return np.asarray(blas.dsyrk(1.0, np.asfortranarray(columns), trans=1, lower=1))


def _whitening(gram: FloatArray, least: float) -> tuple[FloatArray, FloatArray]:
    """Return T (p, k) with T' G T = 1 and the k eigenvalues above `least` of a Gram matrix, lower triangle.

    They are those of its pivoted factor, which ends when no diagonal entry above `least` is left.
    """
    factor, pivots, rank, _ = lapack.dpstrf(np.asfortranarray(gram), lower=1, tol=least)
    lower = np.tril(factor[:, :rank])
    values, vectors = np.linalg.eigh(lower.T @ lower)
    kept = values > least
    whitening = np.empty((len(gram), int(kept.sum())))
    whitening[pivots - 1] = lower @ (vectors[:, kept] / values[kept])
    return whitening, values[kept]


def _full(lower: NDArray[Scalar]) -> NDArray[Scalar]:
    """Return the Hermitian matrix of a lower triangle; whatever is above the diagonal is ignored."""
    part = np.tril(lower)
    return part + np.tril(part, -1).conj().T
