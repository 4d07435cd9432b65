"""The transmission error of a contact model without finite elements, in milliseconds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.contact import (
    ContactModel,
    ContactProblem,
    PatchRule,
    Slices,
    contact_candidates,
    in_pitches,
    solve_contact,
    with_compliances,
    with_gaps,
)
from fe_contact.effects.worth.slice_compliance import slice_compliance
from fe_contact.effects.worth.tooth_bending import half_plane
from fe_contact.geometry import ParallelAxes
from fe_contact.hertz import contact_modulus
from fe_contact.types import FloatArray

PLANE_POSITIONS, FACE_POSITIONS = 64, 32
FACE_SLICES = 21
MOST_PITCHES = 96
"""Base pitches looked at where teeth differ: several turns of usual gears."""
_PATCH, _EDGE = 0.15, 0.0125
"""Half-width of the load patches and their length at an edge, modules."""


@dataclass(frozen=True)
class EstimatedCurve:
    """Mean and peak-to-peak of the transmission error at each load (L,), m."""

    mean: FloatArray
    peak_to_peak: FloatArray


def estimated_curve(pair: ParallelAxes, model: ContactModel, load: FloatArray) -> EstimatedCurve:
    """Solve the contact of springs at normal forces (L,) in N, increasing.

    Everything but the compliance is that of the contact analysis: candidates, gaps, shafts, local approach.
    """
    count = FACE_POSITIONS if model.across_face else PLANE_POSITIONS
    problem = _problem(pair, model, np.arange(count) / count)
    if model.tooth_gaps:
        pitches = np.arange(min(model.period, MOST_PITCHES))
        problem = in_pitches(problem, model, np.repeat(pitches, count))
    deflection = solve_contact(problem, load).deflection
    return EstimatedCurve(np.nanmean(deflection, axis=0), np.nanmax(deflection, 0) - np.nanmin(deflection, 0))


def _problem(pair: ParallelAxes, model: ContactModel, position: FloatArray) -> ContactProblem:
    """Assemble the problem of springs in one base pitch."""
    module = pair.pinion.normal_module
    rule = PatchRule(_PATCH * module, _EDGE * module)
    slices = Slices.of_pair(pair, FACE_SLICES if model.across_face else 1)
    plain = contact_candidates(pair, model, position, rule, slices)
    compliance = slice_compliance(pair, plain, model)
    modulus = contact_modulus(pair.pinion.material, pair.wheel.material)
    springs = ContactProblem(plain, compliance, modulus, half_plane(pair.pinion), half_plane(pair.wheel))
    problem = with_compliances(pair, springs, model)
    return problem.touching(with_gaps(pair, plain, model))
