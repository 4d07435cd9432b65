"""Transmission error to first order in the gaps of single teeth, about states that were solved.

The gap of a tooth pair is the sum of two gaps: one of the pinion's tooth, one of the wheel's. The
*contribution* of a tooth to the transmission error at each position is computed once for every tooth of
either gear, not for every pair of teeth that meets in a hunting cycle. A *state* is the solved contact of one
whole base pitch.

At a given load the transmission error is concave in the gaps: where teeth separate, others carry. So a
tangent lies above it, and the lowest of several tangents is the estimate. Sloping flanks touch near the point
at which their gap is taken, some nanometers closer; the errors that random pitches show contain this.

Axes: t base pitches, P positions in a base pitch, L loads, J pair indices, M candidates of a pair, R teeth, Q
quantities.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fe_contact.contact import Candidates, ContactModel, ContactProblem, ContactSolution
from fe_contact.contact.flank_slope import rolls_at
from fe_contact.contact.load_weights import load_sums, load_weights
from fe_contact.contact.model import MeetingTeeth
from fe_contact.geometry import ParallelAxes
from fe_contact.types import BoolArray, FloatArray, IntArray


@dataclass(frozen=True)
class ToothGaps:
    """Gaps by every tooth of both gears at the candidates of a base pitch."""

    pair: IntArray
    """Pair indices; +1 is ahead. Shape (J,)."""
    period: int
    """Number of base pitches after which the same teeth of both gears count as meeting again."""
    gears: tuple[FloatArray, FloatArray]
    """Gap by each tooth of the pinion and of the wheel, m; zero where a candidate does not exist. Tuple of
    ndarray, shape (J, P, R, M).
    """

    @classmethod
    def of(cls, pair: ParallelAxes, candidates: Candidates, model: ContactModel) -> ToothGaps:
        """Return the `tooth_gaps` of a model at the points where flanks without them touch."""
        first, second = (_by_tooth(pair, candidates, gear, model) for gear in (0, 1))
        return cls(np.unique(candidates.pair), model.period, (first, second))

    def teeth(self, pitches: IntArray) -> tuple[IntArray, IntArray]:
        """Return the teeth (t, J) of both gears that meet in whole base pitches (t,)."""
        meeting = (pitches[:, None] - self.pair) % self.period
        first, second = (meeting % gear.shape[2] for gear in self.gears)
        return first, second


def _by_tooth(pair: ParallelAxes, candidates: Candidates, gear: int, model: ContactModel) -> FloatArray:
    """Return the gaps by the teeth of one gear; one tooth stands for all where they are alike."""
    gear_model = replace(model, tooth_gaps=tuple(term for term in model.tooth_gaps if term.gear == gear))
    touch, can_touch = candidates.touch, np.isfinite(candidates.gap)  # an infinite gap: no candidate
    teeth = min((pair.pinion, pair.wheel)[gear].teeth, model.period) if gear_model.tooth_gaps else 1
    rolls = rolls_at(pair, touch.s_1[can_touch], touch.s_2[can_touch])
    face = np.broadcast_to(candidates.face_position, can_touch.shape)[can_touch]
    gaps = np.zeros((teeth, *can_touch.shape))
    for tooth in range(teeth):
        gaps[tooth][can_touch] = gear_model.gap_of_teeth(MeetingTeeth(pair, np.array(tooth), *rolls, face))
    pairs = np.unique(candidates.pair).size
    by_pair = gaps.reshape(teeth, len(can_touch), pairs, -1)
    return np.ascontiguousarray(np.transpose(by_pair, (2, 1, 0, 3)))  # (J, P, R, M)


@dataclass(frozen=True)
class LoadSums:
    """Means of Q quantities, weighted by the load, to first order in the gaps of teeth about one state."""

    value: FloatArray
    """Means at the state. Shape (P, L, Q)."""
    by_tooth: tuple[FloatArray, FloatArray]
    """Contribution of each tooth of the pinion and of the wheel in each pair. Tuple of ndarray, shape (J, R,
    P, L, Q).
    """
    at_state: FloatArray
    """Sum of the contributions of the teeth of the state. Shape (P, L, Q)."""

    def over(self, gaps: ToothGaps, pitches: IntArray, where: BoolArray) -> FloatArray:
        """Return the means at points (k, Q) of whole base pitches (t,), selected by `where` (t, P, L)."""
        t, p, load = np.nonzero(where)
        return self.value[p, load] - self.at_state[p, load] + self._added(gaps, pitches, t, p, load)

    def about(self, gaps: ToothGaps, pitch: int) -> LoadSums:
        """Return the means about the state of a base pitch."""
        p, load = (index.ravel() for index in np.indices(self.value.shape[:2]))
        added = self._added(gaps, np.array([pitch]), np.zeros(p.size, dtype=np.int64), p, load)
        return replace(self, at_state=added.reshape(self.value.shape))

    def _added(
        self, gaps: ToothGaps, pitches: IntArray, t: IntArray, p: IntArray, load: IntArray
    ) -> FloatArray:
        added = np.zeros((t.size, self.value.shape[2]))
        for tooth_sums, teeth in zip(self.by_tooth, gaps.teeth(pitches), strict=True):
            for j in range(gaps.pair.size):
                added += tooth_sums[j, teeth[t, j], p, load]
        return added


@dataclass(frozen=True)
class Tangent:
    """Transmission error at P positions and L loads about one state, to first order in the gaps of teeth."""

    value: FloatArray
    """Transmission error at the state, m. Shape (P, L)."""
    part: FloatArray
    """Weight of each pair in the contribution of a gap, sum 1. Shape (J, P, L)."""
    by_tooth: tuple[FloatArray, FloatArray]
    """Contribution of each tooth of either gear as a member of each pair, m. Tuple of ndarray, shape (J, R,
    P, L).
    """
    at_state: FloatArray
    """Contribution of the teeth of the state, m. Shape (J, P, L)."""
    sums: LoadSums
    """Means over the load about the same state."""

    def motion(self, gaps: ToothGaps, pitches: IntArray) -> FloatArray:
        """Return the contributions of the teeth that meet in pitches (t,) less the state's, (J, t, P, L)."""
        (first, second), (driving, other) = gaps.teeth(pitches), self.by_tooth
        beyond = driving - self.at_state[:, None]
        motion = np.empty((gaps.pair.size, pitches.size, *self.value.shape))
        for j in range(gaps.pair.size):
            np.add(beyond[j, first[:, j]], other[j, second[:, j]], out=motion[j])
        return motion

    def distance(self, motion: FloatArray, change: FloatArray, where: BoolArray) -> FloatArray:
        """Return the distance of the state from the points selected by `where` (t, P, L), m.

        It is the sum over the pairs of the difference between the `motion` of a pair and its `part` of the
        `change`, which is the sum of the motions.
        """
        total, distance = change[where], np.zeros(np.count_nonzero(where))
        for pair_motion, part in zip(motion, self.part, strict=True):
            distance += np.abs(pair_motion[where] - np.broadcast_to(part, where.shape)[where] * total)
        return distance


@dataclass(frozen=True)
class SolvedState:
    """Solved contact of whole base pitches one after the other."""

    problem: ContactProblem
    solution: ContactSolution
    rows: FloatArray
    """Quantities of the candidates whose means are taken. Shape (Q, P, m)."""


def nominal_tangent(gaps: ToothGaps, state: SolvedState) -> Tangent:
    """Return the tangent about the contact of gears whose teeth are alike."""
    (tangent,) = _tangents(gaps, state, 1)
    return tangent


def pitch_tangents(gaps: ToothGaps, state: SolvedState, pitches: IntArray) -> list[Tangent]:
    """Return the tangents about the whole base pitches (t,) whose contact `state` has."""
    return [
        replace(
            tangent,
            at_state=tangent.motion(gaps, pitches[k : k + 1])[:, 0],
            sums=tangent.sums.about(gaps, int(pitches[k])),
        )
        for k, tangent in enumerate(_tangents(gaps, state, pitches.size))
    ]


def _tangents(gaps: ToothGaps, state: SolvedState, states: int) -> list[Tangent]:
    """Return the tangents about so many `states`, with zero `at_state`, as for teeth without gaps."""
    problem, solution = state.problem, state.solution
    arm = problem.candidates.motion_arm[:, None]
    weight, weights = load_weights(problem, solution, state.rows)
    sums = load_sums(problem, solution, state.rows)
    pairs, loads = gaps.pair.size, solution.load.size
    all_weights = np.concatenate([weight[None], weights]) * arm
    shape = len(all_weights), states, -1, loads, pairs, all_weights.shape[3] // pairs
    by_state = np.transpose(all_weights.reshape(shape), (1, 4, 2, 5, 3, 0))  # (states, J, P, M, L, 1 + Q)
    tangents = []
    for value, mean, parts in zip(
        np.split(solution.deflection, states), np.split(sums, states), by_state, strict=True
    ):
        flat = parts.reshape(*parts.shape[:3], -1)
        first, second = (_sums_by_tooth(gap @ flat, loads) for gap in gaps.gears)
        other_sums = LoadSums(mean, (first[..., 1:], second[..., 1:]), np.zeros(mean.shape))
        part = parts[..., 0].sum(axis=2)
        by_tooth = np.ascontiguousarray(first[..., 0]), np.ascontiguousarray(second[..., 0])
        tangents.append(Tangent(value, part, by_tooth, np.zeros(part.shape), other_sums))
    return tangents


def _sums_by_tooth(added: FloatArray, loads: int) -> FloatArray:
    """Return the contributions of teeth (J, P, R, L (1 + Q)) by tooth first, (J, R, P, L, 1 + Q)."""
    by_tooth = np.swapaxes(added, 1, 2)
    return np.ascontiguousarray(by_tooth).reshape(*by_tooth.shape[:3], loads, -1)
