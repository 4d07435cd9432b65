"""The envelope of a cycle: the least of tangents over all base pitches, about solved states.

A cycle is the period of base pitches after which the teeth of both gears meet again. A state is the solved
contact of one base pitch, or of the nominal gears. A tangent is the transmission error to first order in the
gaps of teeth about a state. It lies above the solution (`tangents`), so that the least of several tangents is
nearest to it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.cycle.drawn_pitches import DrawnPitches
from fe_contact.analysis.cycle.tangents import (
    SolvedState,
    Tangent,
    ToothGaps,
    nominal_tangent,
    pitch_tangents,
)
from fe_contact.analysis.pairs.operating_points import OperatingPoint
from fe_contact.analysis.pairs.solved_contact import problems_in_parts
from fe_contact.contact import Candidates, ContactProblem, ContactSolution, solve_contact
from fe_contact.errors import SolveError
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.cost_of_derivatives import BATCH, DRAWN
from fe_contact.ste.curve_quantities import MEAN, PEAK_TO_PEAK
from fe_contact.types import BoolArray, FloatArray, IntArray

FEWEST = 8
"""Least number of drawn pitches that errors are taken from."""
PART = 4
"""Number of pitches that are solved together. Memory holds the touching points of all of them at once."""
DIVISOR = 4
"""Divisor of the number of base pitches. If derivatives need more than one pitch in `DIVISOR`, all are
solved.
"""

Rows = Callable[[ParallelAxes, Candidates], FloatArray]
"""Function that returns the values (Q, P, m) of candidates whose means over the load are followed."""

Keep = Callable[[SolvedState], Mapping[str, NDArray[Any]]]
"""Function that returns the arrays (P, L, ...) of a state that an envelope keeps, by name."""


def no_rows(_pair: ParallelAxes, c: Candidates) -> FloatArray:
    """Follow the transmission error alone."""
    return np.empty((0, *c.gap.shape))


@dataclass(frozen=True)
class CycleContact:
    """Contact of one alignment at P positions of a base pitch and L loads, in any of its pitches."""

    point: OperatingPoint
    position: FloatArray
    """Position in the base pitch, in [0, 1). Shape (P,)."""
    load: FloatArray
    """Normal force, N. Shape (L,)."""
    rows: Rows = no_rows
    """Further quantities that are followed besides the transmission error."""

    @property
    def pitches(self) -> int:
        """Number of base pitches after which the contact repeats."""
        return self.point.model.period

    def exact(self, pitches: IntArray) -> FloatArray:
        """Return the transmission error in whole base pitches (t,), (t, P, L) in m."""
        parts = problems_in_parts(self.point, self.position, pitches)
        deflection = [_converged_solution(solve_contact(part, self.load)).deflection for part in parts]
        return self.by_pitch(np.concatenate(deflection))

    def solved(self, pitches: IntArray) -> SolvedState:
        """Solve whole base pitches.

        Raises
        ------
        SolveError
            A point has no solution.
        """
        return self._state(*self.point.solve_pitches(self.position, self.load, pitches))

    def nominal(self) -> tuple[ToothGaps, SolvedState]:
        """Return the gaps of single teeth, and the state of gears without them."""
        contact, model = self.point.contact, self.point.model
        alike = replace(model, tooth_gaps=())
        state = self._state(*contact.solve(alike, self.position, self.load))
        return ToothGaps.of(contact.pair, state.problem.candidates, model), state

    def by_pitch(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return rows (t P, ...) by pitch, (t, P, ...)."""
        return values.reshape(-1, self.position.size, *values.shape[1:])

    def _state(self, problem: ContactProblem, solution: ContactSolution) -> SolvedState:
        return SolvedState(
            problem, _converged_solution(solution), self.rows(self.point.contact.pair, problem.candidates)
        )


def in_parts(pitches: IntArray) -> list[IntArray]:
    """Return pitches in parts that are solved together."""
    return np.split(pitches, np.arange(PART, pitches.size, PART)) if pitches.size else []


def _converged_solution(solution: ContactSolution) -> ContactSolution:
    if not solution.converged:
        failed = int(np.count_nonzero(solution.status))
        raise SolveError(f"contact of {failed} points of a cycle was not solved", solution)
    return solution


def keep_nothing(_state: SolvedState) -> Mapping[str, NDArray[Any]]:
    """Keep no array of a state."""
    return {}


@dataclass(frozen=True)
class LeastTangents:
    """Least of some tangents in t pitches, P positions and L loads."""

    ste: FloatArray
    distance: FloatArray
    """`ste`, `distance`: Transmission error by the least tangent, and distance of its state, m. Shape (t, P,
    L) each.
    """
    state: IntArray
    """Index of the least tangent, in the order in which tangents were taken. Shape (t, P, L)."""
    sums: FloatArray
    """Followed quantities, about the state of the least tangent. Shape (t, P, L, Q)."""

    @classmethod
    def of(cls, tangent: Tangent, gaps: ToothGaps, pitches: IntArray) -> LeastTangents:
        """Begin with one tangent in whole base pitches (t,)."""
        motion, every = (
            tangent.motion(gaps, pitches),
            np.ones((pitches.size, *tangent.value.shape), dtype=bool),
        )
        change, shape = motion.sum(axis=0), every.shape
        distance = tangent.distance(motion, change, every).reshape(shape)
        sums = tangent.sums.over(gaps, pitches, every).reshape(*shape, -1)
        return cls(tangent.value + change, distance, np.zeros(shape, dtype=np.int16), sums)

    def and_of(
        self, number: int, tangent: Tangent, gaps: ToothGaps, pitches: IntArray, but: BoolArray
    ) -> LeastTangents:
        """Return the least with another tangent, in the same pitches `but` (t,) some."""
        motion = tangent.motion(gaps, pitches)
        change = motion.sum(axis=0)
        ste = tangent.value + change
        less = (ste < self.ste) & ~but[:, None, None]
        distance, state, sums = self.distance.copy(), self.state.copy(), self.sums
        distance[less], state[less] = tangent.distance(motion, change, less), number
        if sums.shape[3]:
            sums = sums.copy()
            sums[less] = tangent.sums.over(gaps, pitches, less)
        return LeastTangents(np.where(less, ste, self.ste), distance, state, sums)

    @property
    def furthest(self) -> FloatArray:
        """Largest distance in each pitch (t,), m."""
        return np.asarray(self.distance.max(axis=(1, 2)))


@dataclass(frozen=True)
class Envelope:
    """Transmission error in T pitches, P positions and L loads from states that were solved."""

    contact: CycleContact
    keep: Keep
    """Function that selects the arrays of each state that are kept."""
    gaps: ToothGaps
    nominal: FloatArray
    """Mean of gears without gaps of teeth, m. Shape (L,)."""
    pitches: IntArray
    """Base pitches of all states but the first, which is the state of the nominal gears. Shape (K,)."""
    exact: FloatArray
    exact_sums: FloatArray
    """`exact`, `exact_sums`: Solved transmission error, m, and solved followed quantities in `pitches`.
    Ndarray, shapes (K, P, L), (K, P, L, Q).
    """
    arrays: Mapping[str, NDArray[Any]]
    """Arrays (1 + K, P, L, ...) of all states by name."""
    minimum: LeastTangents
    """Least tangents in all pitches."""
    drawn: IntArray
    """Pitches that were drawn: the first of the states. Shape (C,)."""
    without: LeastTangents
    """Least tangents in the drawn pitches, each without the tangent about its own state."""

    @classmethod
    def of(cls, contact: CycleContact, keep: Keep = keep_nothing) -> Envelope:
        """Begin with the nominal gears and `DRAWN` pitches of a cycle that has as many."""
        gaps, state = contact.nominal()
        tangent = nominal_tangent(gaps, state)
        minimum = LeastTangents.of(tangent, gaps, np.arange(contact.pitches))
        drawn = np.random.default_rng(0).choice(contact.pitches, DRAWN, replace=False)
        without = LeastTangents.of(tangent, gaps, drawn)
        no_curves = np.empty((0, *minimum.ste.shape[1:]))
        return cls(
            contact=contact,
            keep=keep,
            gaps=gaps,
            nominal=tangent.value.mean(axis=0),
            pitches=np.empty(0, dtype=np.int64),
            exact=no_curves,
            exact_sums=np.empty((0, *minimum.sums.shape[1:])),
            arrays={name: values[None] for name, values in keep(state).items()},
            minimum=minimum,
            drawn=drawn,
            without=without,
        ).about(drawn)

    @classmethod
    def about_all(cls, contact: CycleContact, pitches: IntArray, keep: Keep = keep_nothing) -> Envelope:
        """Take the tangents about the drawn pitches and others."""
        envelope = cls.of(contact, keep)
        return envelope.about(np.setdiff1d(pitches, envelope.pitches))

    def about(self, pitches: IntArray) -> Envelope:
        """Solve pitches and take the tangents about them too."""
        envelope = self
        for part in in_parts(pitches):
            envelope = envelope._about(part)
        return envelope

    def _about(self, pitches: IntArray) -> Envelope:
        contact, gaps, minimum, without = self.contact, self.gaps, self.minimum, self.without
        state, every = contact.solved(pitches), np.arange(contact.pitches)
        tangents, nowhere = pitch_tangents(gaps, state, pitches), np.zeros(contact.pitches, dtype=bool)
        for k, tangent in enumerate(tangents):
            number = 1 + self.pitches.size + k
            minimum = minimum.and_of(number, tangent, gaps, every, nowhere)
            # its own tangent is no test of a pitch
            without = without.and_of(number, tangent, gaps, self.drawn, self.drawn == pitches[k])
        added = {name: contact.by_pitch(values) for name, values in self.keep(state).items()}
        return replace(
            self,
            pitches=np.concatenate([self.pitches, pitches]),
            exact=np.concatenate([self.exact, [tangent.value for tangent in tangents]]),
            exact_sums=np.concatenate([self.exact_sums, [tangent.sums.value for tangent in tangents]]),
            arrays={name: np.concatenate([known, added[name]]) for name, known in self.arrays.items()},
            minimum=minimum,
            without=without,
        )

    @property
    def solved(self) -> BoolArray:
        """Whether each pitch was solved, (T,)."""
        solved = np.zeros(self.contact.pitches, dtype=bool)
        solved[self.pitches] = True
        return solved

    @property
    def next(self) -> IntArray:
        """The `BATCH` pitches to solve next, no two of them neighbors.

        First come pitches that may hold an end of the range, then those furthest from their tangent's state.
        """
        ends = self._beyond.max(axis=(0, 2))
        ends = np.argsort(-ends, kind="stable")[: min(BATCH // 2, np.count_nonzero(ends > 0.0))]
        far = np.argsort(-self.minimum.furthest, kind="stable")
        chosen, solved = list[int](), self.solved
        for pitch in [*ends.tolist(), *far.tolist()]:
            if len(chosen) < BATCH and not solved[pitch] and all(abs(pitch - k) > 1 for k in chosen):
                chosen.append(pitch)
        return np.array(chosen)

    @property
    def drawn_errors(self) -> DrawnPitches:
        """Errors of tangents in the drawn pitches, each without the tangent about its own state.

        Drawn pitches at a larger distance from the other states than every unsolved pitch are left out: they
        represent none of the unsolved pitches. At least `FEWEST` drawn pitches count.
        """
        return self._drawn_errors(self.without.ste - self.exact[: self.drawn.size])

    def drawn_sum_errors(self, q: int) -> DrawnPitches:
        """Return the errors of tangents in the drawn pitches for the followed quantity q."""
        return self._drawn_errors((self.without.sums - self.exact_sums[: self.drawn.size])[..., q])

    def _drawn_errors(self, errors: FloatArray) -> DrawnPitches:
        order = np.argsort(self.without.furthest, kind="stable")
        left = self.minimum.furthest[~self.solved].max()
        count = max(int(np.count_nonzero(self.without.furthest <= left)), FEWEST)
        return DrawnPitches(errors[order[:count]], self.contact.position)

    @property
    def ste(self) -> FloatArray:
        """Transmission error (T, P, L), m: solved, or the least tangent less its mean error."""
        return self.exact_in(self.minimum.ste - self.drawn_errors.correction, self.exact)

    def sum(self, q: int) -> FloatArray:
        """Return the followed quantity q, corrected as the transmission error is, (T, P, L)."""
        values = self.minimum.sums[..., q] - self.drawn_sum_errors(q).correction
        return self.exact_in(values, self.exact_sums[..., q])

    def exact_in(self, values: NDArray[Any], exact: NDArray[Any]) -> NDArray[Any]:
        """Return values (T, ...) with those of the states (K, ...) in the pitches that were solved."""
        values = values.copy()
        values[self.pitches] = exact
        return values

    def nearest(self, name: str) -> NDArray[Any]:
        """Return the kept array of the state whose tangent is least, by its name, (T, P, L, ...)."""
        p, load = np.indices(self.minimum.state.shape[1:])
        return np.asarray(self.arrays[name][self.minimum.state, p, load])

    @property
    def quantity_errors(self) -> FloatArray:
        """Errors of mean, peak-to-peak, orders beside the mesh and mesh harmonics (23, L), m."""
        errors = self.drawn_errors.quantity_errors
        errors[PEAK_TO_PEAK] = np.maximum(self._beyond.max(axis=1).sum(axis=0), errors[MEAN])
        return errors

    def sum_errors(self, q: int) -> FloatArray:
        """Return the errors of curves of the followed quantity q; both ends may have the largest error."""
        drawn = self.drawn_sum_errors(q)
        errors = drawn.quantity_errors
        errors[PEAK_TO_PEAK] = 2.0 * drawn.error
        return errors

    @property
    def _beyond(self) -> FloatArray:
        """Bounds by which unsolved pitches may exceed the range of the solved ones, (2, T, L) in m.

        The first is the bound above: the least tangent plus the largest amount by which a drawn pitch exceeds
        its tangent. The second is the bound below: the least tangent less the largest error of the tangents.
        """
        errors, known = self.drawn_errors.tangent_error, self.exact
        above = self.minimum.ste.max(axis=1) + np.maximum(-errors.min(axis=(0, 1)), 0.0)
        below = self.minimum.ste.min(axis=1) - errors.max(axis=(0, 1))
        beyond = np.stack([above - known.max(axis=(0, 1)), known.min(axis=(0, 1)) - below])
        return np.where(self.solved[:, None], 0.0, np.maximum(beyond, 0.0))


def chosen(
    contact: CycleContact, tolerance: AllowedError, part: float = 1.0, keep: Keep = keep_nothing
) -> Envelope | None:
    """Solve as many pitches as a part of the error allowed needs; None where that is one in `DIVISOR`."""
    envelope = Envelope.of(contact, keep)
    envelope = envelope.about(envelope.next)
    while not _within(tolerance, part, envelope):
        if DIVISOR * envelope.pitches.size > contact.pitches:
            return None
        envelope = envelope.about(envelope.next)
    return envelope


def _within(tolerance: AllowedError, part: float, envelope: Envelope) -> bool:
    """Whether derivatives give mean and peak-to-peak within a part of the tolerance, at all loads.

    The mean is that of nominal gears: deviations turn the gears, and it may be zero.
    """
    ste, errors = envelope.ste, envelope.quantity_errors
    values = np.stack([envelope.nominal, np.ptp(ste, axis=(0, 1))])
    return bool(np.all(errors[[MEAN, PEAK_TO_PEAK]] <= part * tolerance.of(values)))
