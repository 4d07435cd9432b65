"""The transmission error of a contact model without finite elements, in milliseconds."""

from __future__ import annotations

from dataclasses import dataclass, field

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
    with_gaps,
)
from fe_contact.effects.influence.slice_compliance import slice_compliance
from fe_contact.effects.influence.tooth_bending import half_plane
from fe_contact.geometry import ParallelAxes
from fe_contact.hertz import contact_modulus
from fe_contact.types import FloatArray

PLANE_POSITIONS, FACE_POSITIONS = 64, 32
FACE_SLICES = 11
MOST_PITCHES = 96
"""Base pitches looked at where teeth differ: several turns of usual gears."""
_PATCH, _EDGE = 0.15, 0.0125
"""Half-width of the load patches and their length at an edge, modules."""


@dataclass(frozen=True)
class EstimatedCurve:
    """Mean and peak-to-peak of the transmission error at each load (L,), m."""

    mean: FloatArray
    peak_to_peak: FloatArray


@dataclass(frozen=True)
class Springs:
    """Slice models of one pair; what states of it have in common is assembled once.

    Attributes
    ----------
    pair : GearPair or InternalGearPair
    """

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
            pitches = np.arange(min(model.period, MOST_PITCHES))
            problem = in_pitches(problem, model, np.repeat(pitches, count))
        curve = self._solved(problem, model, load)
        return EstimatedCurve(np.nanmean(curve, axis=0), np.nanmax(curve, axis=0) - np.nanmin(curve, axis=0))

    def problem(self, model: ContactModel) -> ContactProblem:
        """Return the contact problem of one base pitch with the gaps and compliances of a model."""
        problem = with_compliances(self.pair, self._springs(model), model)
        return problem.touching(with_gaps(self.pair, problem.candidates, model))

    def _solved(self, problem: ContactProblem, model: ContactModel, load: FloatArray) -> FloatArray:
        """Solve a problem (P, L) in m, started from the last one with the same gaps."""
        key = repr(model.gaps), problem.candidates.position.size, load.size
        solution = solve_contact(problem, load, self._last.get(key))
        self._last[key] = Start(problem.candidates, solution.force)
        return solution.deflection

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
        """Return where plain involutes can touch."""
        key = model.corner_contact, model.across_face
        if key not in self._plain:
            module, count = self.pair.pinion.normal_module, _positions(model)
            rule = PatchRule(_PATCH * module, _EDGE * module)
            slices = Slices.of_pair(self.pair, FACE_SLICES if model.across_face else 1)
            self._plain[key] = contact_candidates(self.pair, model, np.arange(count) / count, rule, slices)
        return self._plain[key]


def _positions(model: ContactModel) -> int:
    return FACE_POSITIONS if model.across_face else PLANE_POSITIONS
