"""What the transmission error under load is made of, by the slice model.

Where flanks carry, m_q d = m_q g_q + (N K h)_q + lambda_q. The work of the forces F_q in this, over
sum_q m_q F_q, splits the transmission error d exactly: every part is its own displacement, weighted by the
forces. What is left of d after gaps, teeth, bodies and shafts is the contact's own approach.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from fe_contact.contact import (
    Candidates,
    ContactModel,
    ContactProblem,
    PatchRule,
    Slices,
    Start,
    contact_candidates,
    in_pitches,
    solve_contact,
    with_compliances,
    with_flanks,
)
from fe_contact.effects.composer import compose
from fe_contact.effects.effect import ContactScene
from fe_contact.effects.influence.slice_compliance import half_plane, slice_compliance, slice_compliances
from fe_contact.geometry import ParallelAxes
from fe_contact.hertz import contact_modulus
from fe_contact.types import FloatArray, IntArray

# The transmission error of a contact model without finite elements, in milliseconds.

PLANE_POSITIONS, FACE_POSITIONS = 64, 32
FACE_SLICES = 11
MOST_PITCHES = 32
"""Base pitches looked at where teeth differ."""
_PATCH, _EDGE = 0.15, 0.0125
"""Half-width of the load patches and their length at an edge, modules."""

_MOST_STEPS, _EVEN = 512, 3
UNEVEN_PITCHES = 4
"""Base pitches looked at beside these, those of the teeth that deviate most."""
Both = tuple[FloatArray, FloatArray]


@dataclass(frozen=True)
class EstimatedCurve:
    """Mean and peak-to-peak of the transmission error at each load (L,), m."""

    mean: FloatArray
    peak_to_peak: FloatArray


@dataclass(frozen=True)
class Springs:
    """Slice models of one pair; what states of it have in common is assembled once."""

    pair: ParallelAxes
    _known: dict[tuple[object, ...], ContactProblem] = field(default_factory=dict, repr=False)
    _plain: dict[tuple[bool, bool], Candidates] = field(default_factory=dict, repr=False)
    _last: dict[tuple[object, ...], Start] = field(default_factory=dict, repr=False)

    def curve(self, model: ContactModel, load: FloatArray) -> EstimatedCurve:
        """Solve the contact of springs at normal forces (L,) in N, increasing.

        Everything but the compliance is that of the contact analysis: candidates, gaps, shafts, local
        approach.
        """
        problem, count = self.problem(model), _positions(model)
        if model.tooth_gaps:
            pitches = np.union1d(
                spread_pitches([term.period for term in model.tooth_gaps]), _uneven_pitches(self.pair, model)
            )
            problem = in_pitches(self.pair, problem, model, np.repeat(pitches, count))
        key = repr(model.gaps), problem.candidates.position.size, load.size
        solution = solve_contact(problem, load, self._last.get(key))
        self._last[key] = Start(problem.candidates, solution.force)
        curve = solution.deflection  # (P, L), m; started from the last one with the same gaps
        return EstimatedCurve(np.nanmean(curve, axis=0), np.nanmax(curve, axis=0) - np.nanmin(curve, axis=0))

    def problem(self, model: ContactModel) -> ContactProblem:
        """Return the contact problem of one base pitch with the gaps and compliances of a model."""
        problem = with_compliances(self.pair, self._springs(model), model)
        return with_flanks(self.pair, problem, model)

    def _springs(self, model: ContactModel) -> ContactProblem:
        """Return the springs of a model in one base pitch, flanks as plain involutes."""
        bodies = (model.couple_teeth, model.finite_width, model.parts)
        key = (model.corner_contact, model.across_face, *bodies)
        if key not in self._known:
            plain = self._candidates(model)
            compliance = slice_compliance(self.pair, plain.slices, model)
            modulus = contact_modulus(self.pair.pinion.material, self.pair.wheel.material)
            planes = half_plane(self.pair.pinion), half_plane(self.pair.wheel)
            self._known[key] = ContactProblem(plain, compliance, modulus, *planes)
        return self._known[key]

    def _candidates(self, model: ContactModel) -> Candidates:
        key = model.corner_contact, model.across_face
        if key not in self._plain:
            module, count = self.pair.pinion.normal_module, _positions(model)
            rule = PatchRule(_PATCH * module, _EDGE * module)
            slices = Slices.of_pair(self.pair, FACE_SLICES if model.across_face else 1)
            self._plain[key] = contact_candidates(self.pair, model, np.arange(count) / count, rule, slices)
        return self._plain[key]


def spread_pitches(periods: Sequence[int]) -> IntArray:
    """Return at most `MOST_PITCHES` base pitches of gears that repeat after so many, by equal steps.

    Of all steps the one by which both gears stand most evenly at all their angles, and against each other:
    the orders up to `_EVEN` of both, their sums and differences have the least mean.
    """
    whole = math.lcm(*periods)
    if whole <= MOST_PITCHES:
        return np.arange(whole)
    rates = np.zeros(1)
    for period in {*periods} - {1}:
        rates = np.add.outer(rates, np.arange(-_EVEN, _EVEN + 1) / period).ravel()
    rates = rates[np.abs(rates) > 1e-12]
    step, index = np.arange(1, min(whole, _MOST_STEPS)), np.arange(MOST_PITCHES)
    angle = 2.0 * np.pi * step[:, None, None] * rates[:, None] * index
    steadiness = np.abs(np.exp(1j * angle).mean(axis=-1)).max(axis=1)
    return np.sort(index * step[int(steadiness.argmin())] % whole)


def _uneven_pitches(pair: ParallelAxes, model: ContactModel) -> IntArray:
    """Return the base pitches in which pair 0 deviates most from the nominal flanks."""
    extent = model.extent(pair, np.arange(model.period))
    reach = np.maximum(np.asarray(extent.high), -np.asarray(extent.low))
    return np.argsort(-reach, kind="stable")[:UNEVEN_PITCHES]


def _positions(model: ContactModel) -> int:
    return FACE_POSITIONS if model.across_face else PLANE_POSITIONS


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
    """`teeth`, `bodies`: Bending, shear and compression of the teeth with what they are clamped in; body, web
    and seat. Shape (ndarray, ndarray) each.
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
    held: FloatArray
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
        return np.asarray(np.einsum("pi,pij,pj->p", self.held, compliance, self.held) / self.motion)
