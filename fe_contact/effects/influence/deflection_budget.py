"""Budget of the transmission error under load, by the slice model.

Where flanks carry, m_q d = m_q g_q + (N K h)_q + lambda_q. The work of the forces F_q in this, over
sum_q m_q F_q, splits the transmission error d exactly: every part is its own displacement, weighted by the
forces. The rest of d after gaps, teeth, bodies and shafts is the approach of the contact.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fe_contact.contact import Candidates, solve_contact, with_compliances
from fe_contact.effects.composer import compose
from fe_contact.effects.effect import ContactScene
from fe_contact.effects.influence.estimated_curve import Both, Springs
from fe_contact.effects.influence.slice_compliance import slice_compliances
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class DeflectionBudget:
    """Parts of the transmission error over a base pitch, (P,) in m; (driving, driven) where there are two."""

    modification: FloatArray
    misalignment: FloatArray
    corner: FloatArray
    """`modification`, `misalignment`, `corner`: Gaps that the load closes: of the flanks' modifications, of
    their misalignment, and of tip edges that touch off the line of action.
    """
    teeth: Both
    bodies: Both
    """`teeth`, `bodies`: Bending, shear and compression of the teeth with their foundations; deflection of
    body, web and seat. Shape (ndarray, ndarray) each.
    """
    shafts: FloatArray
    """Bending of shafts and bearings."""
    contact: FloatArray
    """Hertz: from the contact strip to the middle of either tooth."""

    @property
    def total(self) -> FloatArray:
        """The transmission error (P,), m."""
        gaps = self.modification + self.misalignment + self.corner
        return np.asarray(gaps + sum(self.teeth) + sum(self.bodies) + self.shafts + self.contact)


def deflection_budget(scene: ContactScene, choices: dict[str, str]) -> DeflectionBudget:
    """Split the transmission error of a scene at its largest torque and misalignment.

    Parameters
    ----------
    scene : ContactScene
        Teeth are alike: pitch errors are no part of it.
    choices : dict of str to str
        Effect name to "on", "off" or "auto".

    Raises
    ------
    InputError
        Unknown effect or choice.
    """
    model, _ = compose(scene, choices)
    aligned, _ = compose(replace(scene, misalignment=np.zeros(1)), choices)
    springs = Springs(scene.pair)
    problem = springs.problem(model)
    solution = solve_contact(problem, scene.pair.normal_force(scene.torque[-1:]))
    load = _Weights.of(problem.candidates, solution.force[:, 0])
    gaps, involutes = load.gap(problem.candidates), springs.problem(replace(model, gaps=())).candidates
    modified, corner = load.gap(springs.problem(aligned).candidates), load.gap(involutes)
    first, second = slice_compliances(scene.pair, involutes.slices, model)
    teeth = load.displacement(first.tooth), load.displacement(second.tooth)
    bodies = load.displacement(first.body), load.displacement(second.body)
    rigid = replace(problem, compliance=np.zeros_like(problem.compliance))
    shafts = load.displacement(with_compliances(scene.pair, rigid, model).compliance)
    contact = np.asarray(solution.deflection[:, 0] - gaps - sum(teeth) - sum(bodies) - shafts)
    return DeflectionBudget(modified - corner, gaps - modified, corner, teeth, bodies, shafts, contact)


@dataclass(frozen=True)
class _Weights:
    """Forces (P, m) by motion of the candidates, their sum (P,), and forces (P, n) on the slices, N."""

    force: FloatArray
    slice_force: FloatArray
    motion: FloatArray

    @classmethod
    def of(cls, candidates: Candidates, force: FloatArray) -> _Weights:
        """Weigh by the forces (P, m) of a solution."""
        return cls(
            candidates.motion_arm * force,
            candidates.on_slices(force),
            (candidates.motion_arm * force).sum(axis=1),
        )

    def gap(self, candidates: Candidates) -> FloatArray:
        """Return the mean gap (P,) where forces act, m."""
        gap = np.where(self.force > 0.0, candidates.gap, 0.0)
        return np.asarray((self.force * gap).sum(axis=1) / self.motion)

    def displacement(self, compliance: FloatArray) -> FloatArray:
        """Return the mean displacement (P,) by a compliance (P, n, n), m."""
        return np.asarray(
            np.einsum("pi,pij,pj->p", self.slice_force, compliance, self.slice_force) / self.motion
        )
