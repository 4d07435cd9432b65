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

- Loads V are solved for, and what passes less than `MIN_PASSED` to the cuts is not. With P = V V' and
  T_m = B' G_m B V,  B' G_m B = T_m V' + V T_-m' - V V' T_m V'  but for  (1 - P) B' G_m B (1 - P).
- A few harmonics are solved; the others by Galerkin's method in the space of these solutions.
- Directions that hold less than `MIN_ENERGY` of the solutions are left out of it.

What the last two leave unbalanced is measured at every harmonic, and where a flank node is more than
`LARGEST_ERROR` off, the worst harmonic is solved, too.

Thomas, D. L. (1979). Dynamics of rotationally periodic structures. Int. J. Numer. Meth. Engng 14, 81-102.
Quarteroni, A., Manzoni, A., Negri, F. (2016). Reduced basis methods for partial differential equations.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from fe_contact.compliance.cyclic_harmonics import LeftCuts, TurningLoads, left_cuts
from fe_contact.compliance.reduced_harmonics import SOFTENED, least_passed, row_space, solve_few
from fe_contact.errors import SolveError
from fe_contact.types import FloatArray, IntArray
from host.optional_modules import linalg
from model_studies.progress import Report, unreported

STRIP = 256
"""Columns that are mirrored at once."""


@dataclass(frozen=True)
class HeldSector:
    """A sector whose flank freedoms are eliminated."""

    flank: FloatArray
    """A: flank displacement per flank force, cuts held, m/N. Shape (nf, nf)."""
    transmitted: FloatArray
    """B: force on the cuts per flank force, cuts held; also (transposed) flank displacement per displacement
    of the cuts. Left cut first. Shape (2 nc, nf).
    """
    cuts: FloatArray
    """K: stiffness condensed on the cuts, N/m. Shape (2 nc, 2 nc)."""

    @property
    def cut_size(self) -> int:
        """Number of freedoms of one cut."""
        return len(self.cuts) // 2


@dataclass(frozen=True)
class EvenSector:
    """A held sector whose cuts are scaled: K_ll + K_rr = L L' becomes 1."""

    transmitted: FloatArray
    """L^-1 B_l and L^-1 B_r. Shape (2 nc, nf)."""
    across: FloatArray
    """C = L^-1 K_lr L^-T: force on the left cut per displacement of the right one. Shape (nc, nc)."""
    scale: FloatArray
    """L, lower triangle. Shape (nc, nc)."""

    def force(self, forces: FloatArray) -> FloatArray:
        """Return scaled forces L^-1 f of forces (nc, p) on a cut."""
        return np.asarray(linalg.blas.dtrsm(1.0, self.scale, np.asfortranarray(forces), lower=1))

    def displacement(self, scaled: FloatArray) -> FloatArray:
        """Return the displacement L^-T x of a cut from the scaled one, (nc, p)."""
        return np.asarray(linalg.blas.dtrsm(1.0, self.scale, np.asfortranarray(scaled), lower=1, trans_a=1))


@dataclass(frozen=True)
class RingSolution:
    """Flank compliance of the ring, and the cuts under probe loads."""

    blocks: FloatArray
    """S_m: displacement of the flank of tooth m per force on the flank of tooth 0, m/N. Shape (reach + 1, nf,
    nf).
    """
    left: FloatArray
    """Displacement of every left cut under the probe loads on tooth 0, m; its energy is exact as `blocks`.
    Shape (z, nc, p).
    """
    shares: FloatArray = field(default_factory=lambda: np.zeros(0))
    """Shares of the probe loads on each tooth that add up to a load of solved harmonics alone; 1 on tooth 0.
    Shape (z,).
    """
    solved: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))
    """Displacement of the left cuts under the loads with `shares`, m, exact except for rounding. Shape (z,
    nc, p).
    """
    error: float = 0.0
    """Estimated error of `blocks`, over the largest entry of A."""
    bore: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))
    """Displacement of the left cut of every sector under unit forces on the bore of sector 0, where it is
    free to turn, m/N. Shape (z, nc, p).
    """
    turn: FloatArray = field(default_factory=lambda: np.zeros(0))
    """Displacement of a cut under a unit turn of the gear, where it is free to turn, m. Shape (nc,)."""
    restraint: float = 0.0
    """Stiffness against the mean turn of the cuts, N/m per m: force on each left cut is ``turn`` times
    ``restraint`` times ``turn`` times its mean displacement.
    """

    @property
    def restraining(self) -> FloatArray:
        """Forces that restrain the mean turn on each left cut under the probe loads, (nc, p), N."""
        if not self.restraint:
            return np.zeros(self.left.shape[1:])
        mean = self.left.mean(axis=0)
        return np.outer(self.restraint * self.turn, self.turn @ mean)


@dataclass(frozen=True)
class FreeTurn:
    """A gear that nothing in its sectors keeps from turning."""

    turn: FloatArray
    """Displacement of a cut under a unit turn, m. Shape (nc,)."""
    flank: int
    """Number of flank freedoms; the other loaded ones are on the bore."""
    key_cut: IntArray
    """Freedoms of a cut that are on the bore and may be loaded."""


def hold_sector(matrix: FloatArray, flank: int) -> HeldSector:
    """Eliminate the first `flank` freedoms of a condensed stiffness, whose lower triangle is given.

    Raises `SolveError`: the flank block is not positive definite.
    """
    factor, info = linalg.lapack.dpotrf(np.asfortranarray(matrix[:flank, :flank]), lower=1, clean=1)
    if info:
        raise SolveError(f"tooth sector: flank stiffness is not positive definite (pivot {info})")
    coupling = np.asfortranarray(matrix[flank:, :flank])
    linalg.blas.dtrsm(1.0, factor, coupling, side=1, lower=1, trans_a=1, overwrite_b=1)
    rest = np.asfortranarray(matrix[flank:, flank:])
    cuts = linalg.blas.dsyrk(-1.0, coupling, beta=1.0, c=rest, lower=1, overwrite_c=1)
    # Minus: a force on the flank and the force it needs on held cuts point the other way.
    transmitted = linalg.blas.dtrsm(-1.0, factor, coupling, side=1, lower=1, overwrite_b=1)
    inverse, _ = linalg.lapack.dpotri(factor, lower=1, overwrite_c=1)
    return HeldSector(_full(inverse), transmitted, _full(cuts))


def even_sector(sector: HeldSector) -> EvenSector:
    """Scale the cuts of a sector; SolveError if one between two held ones is not stiff in all directions."""
    size = sector.cut_size
    diagonal = sector.cuts[:size, :size] + sector.cuts[size:, size:]
    scale, info = linalg.lapack.dpotrf(np.asfortranarray(diagonal), lower=1, clean=1, overwrite_a=1)
    if info:
        raise SolveError(f"ring of teeth: the stiffness of a cut is not positive definite (pivot {info})")
    even = EvenSector(sector.transmitted, sector.cuts[:size, size:], scale)
    across = linalg.blas.dtrsm(1.0, scale, even.force(even.across), side=1, lower=1, trans_a=1, overwrite_b=1)
    transmitted = np.concatenate([even.force(part) for part in np.split(sector.transmitted, 2)])
    return EvenSector(transmitted, across, scale)


def close_ring(
    sector: HeldSector,
    teeth: int,
    reach: int,
    probes: FloatArray,
    free: FreeTurn | None = None,
    report: Report = unreported,
) -> RingSolution:
    """Join `teeth` copies of a sector.

    Raises `SolveError`: a harmonic is not positive definite.

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
    """
    even, count = even_sector(sector), probes.shape[1]
    flank = len(sector.flank) if free is None else free.flank
    largest = float(np.abs(sector.flank[:flank, :flank]).max())
    minimum = least_passed(teeth)
    # The probes are among them: blocks hold their energy but for rounding.
    modes, _ = np.linalg.qr(np.concatenate([probes, row_space(even.transmitted, minimum * largest)], axis=1))
    loads, rank = even.transmitted @ np.concatenate([modes, probes], axis=1), modes.shape[1]
    ring, basis, restraint = _turning(sector, even, TurningLoads(even.across, loads, teeth), free)
    closed = solve_few(ring, basis, modes, largest, slice(rank, rank + count), report)
    cuts = left_cuts(closed.solutions, teeth, reach, rank)
    within = np.concatenate([closed.basis.T @ part for part in np.split(even.transmitted, 2)])
    near = [np.concatenate([cuts.near[m], cuts.near[m - 1]]) for m in range(-reach, reach + 1)]
    blocks = _blocks([within.T @ motion for motion in near], modes)
    blocks[0] += sector.flank
    everywhere = even.displacement(closed.basis) @ cuts.everywhere
    solved = np.stack([even.displacement(left) for left in closed.solved])
    return RingSolution(
        blocks,
        everywhere[..., :count],
        closed.shares,
        solved,
        SOFTENED * (closed.error / largest + 2.0 * minimum),
        everywhere[..., count:],
        np.zeros(0) if free is None else free.turn,
        restraint,
    )


def _turning(
    sector: HeldSector, even: EvenSector, ring: TurningLoads, free: FreeTurn | None
) -> tuple[TurningLoads, FloatArray, float]:
    """Restrain a ring that may turn and load its bore; with what its space holds, and the restraint."""
    size = sector.cut_size
    if free is None:
        return ring, np.empty((size, 0)), 0.0
    on_cut = np.zeros((2 * size, len(free.key_cut)))
    on_cut[:size] = even.force(np.eye(size)[:, free.key_cut])
    loads = np.concatenate([ring.loads, even.transmitted[:, free.flank :], on_cut], axis=1)
    restraint = float(np.trace(sector.cuts) / (free.turn @ free.turn))
    spring = np.sqrt(restraint) * even.force(free.turn[:, None])
    basis = even.scale.T @ free.turn[:, None]
    return replace(ring, loads=loads, spring=spring), basis / np.linalg.norm(basis), restraint


def _blocks(motions: list[FloatArray], modes: FloatArray) -> FloatArray:
    """Return B' G_m B (reach + 1, nf, nf) from what modes V (nf, r) move, T_m of m from -reach to reach."""
    reach = len(motions) // 2
    blocks = np.empty((reach + 1, len(modes), len(modes)))
    for m in range(reach + 1):
        ahead = motions[reach + m] - modes @ (modes.T @ motions[reach + m])
        blocks[m] = ahead @ modes.T + modes @ motions[reach - m].T
    return blocks


def loaded_cuts(
    sector: HeldSector, loads: FloatArray, teeth: int, reach: int = -1, first: int = 0
) -> LeftCuts:
    """Return the left cuts under flank `loads` (nf, p) on tooth 0, every harmonic solved; see `left_cuts`."""
    even = even_sector(sector)
    ring = TurningLoads(even.across, even.transmitted @ loads, teeth)
    cuts = left_cuts((ring.solve(number) for number in ring.harmonics), teeth, reach, first)
    near = {j: even.displacement(left) for j, left in cuts.near.items()}
    return LeftCuts(near, np.stack([even.displacement(left) for left in cuts.everywhere]))


def _full(lower: FloatArray) -> FloatArray:
    """Mirror the lower triangle of a matrix up, in its place and strip by strip."""
    for begin in range(0, len(lower), STRIP):
        stop = begin + STRIP
        triangle = np.tril(lower[begin:stop, begin:stop])
        lower[begin:stop, begin:stop] = triangle + np.tril(triangle, -1).T
        lower[begin:stop, stop:] = lower[stop:, begin:stop].T
    return lower
