"""The least of tangents over all pitches of a cycle, about the nominal gears and pitches that were solved."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.cycle.drawn_pitches import DrawnPitches
from fe_contact.analysis.cycle.tangents import Tangent, ToothGaps, nominal_tangent, pitch_tangents
from fe_contact.analysis.pairs.kept_contact import solved_in_parts
from fe_contact.analysis.pairs.pair_contact import OperatingPoint
from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.errors import SolveError
from fe_contact.ste.curve_quantities import MEAN, PEAK_TO_PEAK
from fe_contact.types import BoolArray, FloatArray, IntArray

DRAWN = 16
"""Pitches that are drawn and solved: they tell what the derivatives miss at all others."""
FEWEST = 8
"""Of them that count at least."""
BATCH = 8
"""Further pitches that are solved together."""


@dataclass(frozen=True)
class CycleContact:
    """Contact of one alignment at P positions of a base pitch and L loads, in any of its pitches."""

    point: OperatingPoint
    position: FloatArray
    load: FloatArray

    @property
    def pitches(self) -> int:
        """Base pitches after which it repeats."""
        return self.point.model.period

    def exact(self, pitches: IntArray) -> FloatArray:
        """Return the transmission error in whole base pitches (t,), (t, P, L) in m."""
        (kept,) = solved_in_parts(self.point, self.position, (self.load,), pitches, edges=False)
        return self._by_pitch(_converged(kept.solution))

    def solved(self, pitches: IntArray) -> tuple[ContactProblem, ContactSolution]:
        """Solve whole base pitches.

        Raises
        ------
        SolveError
            A point has no solution.
        """
        problem, solution = self.point.solve_pitches(self.position, self.load, pitches)
        return problem, _converged(solution)

    def nominal(self) -> tuple[ToothGaps, Tangent]:
        """Return the gaps of single teeth, and the tangent about gears without them."""
        contact, model = self.point.contact, self.point.model
        problem, solution = contact.solve(replace(model, tooth_gaps=()), self.position, self.load)
        gaps = ToothGaps.of(contact.pair, problem.candidates, model)
        return gaps, nominal_tangent(contact.pair, gaps, problem, solution)

    def tangents(self, gaps: ToothGaps, pitches: IntArray) -> tuple[FloatArray, list[Tangent]]:
        """Return the transmission error in whole base pitches (t, P, L) in m, and the tangents about them."""
        problem, solution = self.solved(pitches)
        tangents = pitch_tangents(self.point.contact.pair, gaps, problem, solution, pitches)
        return self._by_pitch(solution), tangents

    def _by_pitch(self, solution: ContactSolution) -> FloatArray:
        return solution.deflection.reshape(-1, self.position.size, self.load.size)


def _converged(solution: ContactSolution) -> ContactSolution:
    if not solution.converged:
        failed = int(np.count_nonzero(solution.status))
        raise SolveError(f"contact of {failed} points of a cycle was not solved", solution)
    return solution


@dataclass(frozen=True)
class LeastTangents:
    """Least of some tangents in t pitches, P positions and L loads.

    Attributes
    ----------
    ste, distance : ndarray, shape (t, P, L)
        Transmission error by the least one, and how far its state is, m.
    """

    ste: FloatArray
    distance: FloatArray

    def and_of(self, ste: FloatArray, distance: FloatArray) -> LeastTangents:
        """Return the least with another tangent."""
        less = ste < self.ste
        return LeastTangents(np.where(less, ste, self.ste), np.where(less, distance, self.distance))

    @property
    def furthest(self) -> FloatArray:
        """Largest distance in each pitch (t,), m."""
        return np.asarray(self.distance.max(axis=(1, 2)))


@dataclass(frozen=True)
class Envelope:
    """Transmission error in T pitches, P positions and L loads from states that were solved.

    Attributes
    ----------
    nominal : ndarray, shape (L,)
        Mean of gears without gaps of teeth, m.
    solved : ndarray of bool, shape (T,)
    exact : ndarray, shape (T, P, L)
        Where it was solved, m.
    least : LeastTangents
        In all pitches.
    drawn : ndarray of int, shape (C,)
        Pitches that were drawn.
    without : LeastTangents
        In those, of all tangents but their own.
    """

    gaps: ToothGaps
    nominal: FloatArray
    solved: BoolArray
    exact: FloatArray
    least: LeastTangents
    drawn: IntArray
    without: LeastTangents

    @classmethod
    def of(cls, contact: CycleContact) -> Envelope:
        """Begin with the nominal gears and `DRAWN` pitches of a cycle that has as many."""
        gaps, nominal = contact.nominal()
        least = LeastTangents(*nominal.over(gaps, np.arange(contact.pitches)))
        drawn = np.random.default_rng(0).choice(contact.pitches, DRAWN, replace=False)
        without = LeastTangents(least.ste[drawn], least.distance[drawn])
        nothing = np.full(least.ste.shape, np.nan)
        unsolved, mean = np.zeros(contact.pitches, dtype=bool), nominal.value.mean(axis=0)
        return cls(gaps, mean, unsolved, nothing, least, drawn, without).about(contact, drawn)

    def about(self, contact: CycleContact, pitches: IntArray) -> Envelope:
        """Solve pitches and take the tangents about them too."""
        values, tangents = contact.tangents(self.gaps, pitches)
        solved, exact, least, without = self.solved.copy(), self.exact.copy(), self.least, self.without
        solved[pitches], exact[pitches] = True, values
        for pitch, tangent in zip(pitches, tangents, strict=True):
            ste, distance = tangent.over(self.gaps, np.arange(solved.size))
            least = least.and_of(ste, distance)
            own = (self.drawn == pitch)[:, None, None]  # its own tangent is no test of a pitch
            without = without.and_of(np.where(own, np.inf, ste[self.drawn]), distance[self.drawn])
        return replace(self, solved=solved, exact=exact, least=least, without=without)

    @property
    def next(self) -> IntArray:
        """The `BATCH` pitches to solve next, none beside another.

        First those that may hold an end of the range, then those furthest from what stands for them.
        """
        ends = self._beyond.max(axis=(0, 2))
        ends = np.argsort(-ends, kind="stable")[: min(BATCH // 2, np.count_nonzero(ends > 0.0))]
        far = np.argsort(-self.least.furthest, kind="stable")
        chosen: list[int] = []
        for pitch in [*ends.tolist(), *far.tolist()]:
            if len(chosen) < BATCH and not self.solved[pitch] and all(abs(pitch - k) > 1 for k in chosen):
                chosen.append(pitch)
        return np.array(chosen)

    @property
    def missed(self) -> DrawnPitches:
        """What tangents about other states miss in the drawn pitches.

        Pitches further than any that is left stand for none of those: they would have been solved.
        """
        missed = self.without.ste - self.exact[self.drawn]
        order = np.argsort(self.without.furthest, kind="stable")
        left = self.least.furthest[~self.solved].max()
        count = max(int(np.count_nonzero(self.without.furthest <= left)), FEWEST)
        return DrawnPitches(missed[order[:count]])

    @property
    def ste(self) -> FloatArray:
        """Transmission error (T, P, L), m: solved, or the least tangent less what it misses in the mean."""
        return np.where(self.solved[:, None, None], self.exact, self.least.ste - self.missed.correction)

    @property
    def quantity_errors(self) -> FloatArray:
        """Errors of mean, peak-to-peak, orders beside the mesh and mesh harmonics (23, L), m."""
        errors = self.missed.quantity_errors
        errors[PEAK_TO_PEAK] = np.maximum(self._beyond.max(axis=1).sum(axis=0), errors[MEAN])
        return errors

    @property
    def _beyond(self) -> FloatArray:
        """By how much pitches may stand out of the range of those solved, above and below, (2, T, L) in m.

        Above a tangent nothing lies but what drawn pitches show, below it no more than is missed at most.
        """
        missed = self.missed.missed
        above = self.least.ste.max(axis=1) + np.maximum(-missed.min(axis=(0, 1)), 0.0)
        below = self.least.ste.min(axis=1) - missed.max(axis=(0, 1))
        known = self.exact[self.solved]
        beyond = np.stack([above - known.max(axis=(0, 1)), known.min(axis=(0, 1)) - below])
        return np.where(self.solved[:, None], 0.0, np.maximum(beyond, 0.0))
