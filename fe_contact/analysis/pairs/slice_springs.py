"""Contact of uncoupled slices: every slice of every tooth pair is an independent spring.

The deflection d (the transmission error) of springs with stiffness k_i, gap g_i and lever arms a_i (of the
motion) and t_i (of the torque) under the normal force F obeys

    sum_i t_i k_i a_i max(0, d - g_i) = F,

whose left side is increasing and piecewise linear in d: with the gaps in increasing order the solution lies
in the first interval whose end carries at least F. No iteration is needed. Axes: P positions, L loads, n
candidates, which are the slices of all tooth pairs.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.contact import (
    Candidates,
    ContactModel,
    ContactProblem,
    ContactSolution,
    Slices,
    Start,
    contact_candidates,
    in_pitches,
    with_gaps,
)
from fe_contact.geometry import ParallelAxes
from fe_contact.hertz import contact_modulus
from fe_contact.types import FloatArray, IntArray, Status

SLICES = 65
"""Slices of the common face; uncoupled slices cost next to nothing."""


@dataclass(frozen=True)
class SliceLaw:
    """The stiffness law of slices, and what it neglects; each fidelity has its law."""

    line_stiffness: Callable[[ParallelAxes, Candidates], FloatArray]
    """Function of pair and candidates: transverse stiffness per unit face width (P, n), N/m per m."""
    with_gaps: bool
    """Whether gaps between the flanks act: modifications, deviations, alignment, corner contact. Without
    gaps the part of a slice that lies on the path of contact touches.
    """


@dataclass(frozen=True)
class SpringContact(PairContact):
    """A pair whose teeth are uncoupled slices. Of its `plan` only the load patches matter."""

    law: SliceLaw = field(kw_only=True)
    """Stiffness of the slices."""

    def solve(
        self,
        model: ContactModel,
        position: FloatArray,
        load: FloatArray,
        pitch: IntArray | None = None,
        start: Start | None = None,
    ) -> tuple[ContactProblem, ContactSolution]:
        """Solve positions (P,) at normal forces (L,) in N; parameters as of `PairContact.solve`.

        Uncoupled slices need no start.
        """
        effective_model = model if self.law.with_gaps else ContactModel()
        slices = Slices.of_pair(self.pair, SLICES, 1)
        plain = contact_candidates(self.pair, effective_model, position, self.plan.patch, slices)
        touching = with_gaps(self.pair, plain, effective_model)
        modulus = contact_modulus(self.pair.pinion.material, self.pair.wheel.material)
        # without compliance matrices: slices are uncoupled
        problem = ContactProblem(touching, np.zeros((position.size, 0, 0)), modulus, 0.0, 0.0)
        if pitch is not None or effective_model.tooth_gaps:
            first = np.zeros_like(position, int)
            problem = in_pitches(self.pair, problem, effective_model, first if pitch is None else pitch)
        stiffness = slice_stiffness(self.pair, problem.candidates, self.law)
        return problem, _solve_springs(problem.candidates, stiffness, load)


def slice_stiffness(pair: ParallelAxes, candidates: Candidates, law: SliceLaw) -> FloatArray:
    """Return the normal force per normal approach (P, n) of each slice, N/m.

    The transverse stiffness is c b_slice. Along the normal the force is 1/cos(beta_b) times the transverse
    one and the approach cos(beta_b) times: the stiffness is c b_slice / cos(beta_b)^2. The `width` of a
    candidate is the length b_slice / cos(beta_b) of its contact line, without the part off the path of
    contact.
    """
    return np.asarray(
        law.line_stiffness(pair, candidates) * candidates.width / math.cos(pair.base_helix_angle)
    )


def _solve_springs(candidates: Candidates, stiffness: FloatArray, load: FloatArray) -> ContactSolution:
    """Solve at normal forces (L,) in N, exactly; `stiffness` (P, n) is force per normal approach, N/m."""
    arm, share, gap = candidates.motion_arm, candidates.torque_share, candidates.gap
    weight = np.where(np.isfinite(gap), share * stiffness * arm, 0.0)
    order = np.argsort(gap, axis=1)
    gaps = np.take_along_axis(np.where(np.isfinite(gap), gap, 0.0), order, axis=1)
    weights = np.take_along_axis(weight, order, axis=1)
    total, moment = np.cumsum(weights, axis=1), np.cumsum(weights * gaps, axis=1)
    # force at which the next spring begins to touch; after the last there is none
    onset = gaps[:, 1:] * total[:, :-1] - moment[:, :-1]
    onset = np.where(weights[:, 1:] > 0.0, onset, np.inf)
    active = (onset[:, :, None] < load).sum(axis=1)  # index of the last spring that touches, (P, L)
    slope = np.take_along_axis(total, active, axis=1)
    deflection = (load + np.take_along_axis(moment, active, axis=1)) / slope
    closing = np.maximum(deflection[:, :, None] - np.where(np.isfinite(gap), gap, np.inf)[:, None, :], 0.0)
    force = (stiffness * arm)[:, None, :] * closing
    return _solution(candidates, load, deflection, 1.0 / slope, force)


def _solution(
    candidates: Candidates, load: FloatArray, deflection: FloatArray, tangent: FloatArray, force: FloatArray
) -> ContactSolution:
    """Return the solution as a `ContactSolution`; its only residual is the rounding of the equilibrium."""
    residuals = np.zeros((*deflection.shape, 4))
    carried = (force * candidates.torque_share[:, None, :]).sum(axis=2)
    residuals[..., 0] = np.abs(carried - load) / load
    return ContactSolution(
        load=load,
        deflection=deflection,
        tangent=tangent,
        force=force,
        status=np.full(deflection.shape, int(Status.CONVERGED), dtype=np.int64),
        iterations=np.zeros(deflection.shape, dtype=np.int64),
        residuals=residuals,
        beyond=np.zeros(deflection.shape, dtype=np.bool_),
        no_load=np.min(candidates.gap, axis=1),
    )
