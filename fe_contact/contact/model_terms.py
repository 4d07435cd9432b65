"""Gaps and compliances of the contact model, added to a problem of plain involutes."""

from __future__ import annotations

from dataclasses import replace

from fe_contact.contact.candidates import with_gaps
from fe_contact.contact.flank_slope import rolls_at
from fe_contact.contact.model import ContactModel
from fe_contact.contact.plain_touch import Touch
from fe_contact.contact.problem import ContactProblem
from fe_contact.geometry import ParallelAxes


def with_flanks(
    pair: ParallelAxes, problem: ContactProblem, model: ContactModel, touch: Touch | None = None
) -> ContactProblem:
    """Add the gaps of the model to a problem of plain involutes.

    Where patches follow the flanks, the touch says how far the middles of the strips have moved.
    `touch`: where the flanks touch, if it is known.
    """
    plain = problem.candidates
    modified = with_gaps(pair, plain, model) if touch is None else plain.touching(touch)
    if problem.tilt.size and model.sloped:
        modified = problem.candidates.following(modified.touch)
    return problem.touching(modified)


def with_compliances(pair: ParallelAxes, problem: ContactProblem, model: ContactModel) -> ContactProblem:
    """Add the compliance terms of the model, at the touching points of plain involutes.

    They couple all slices of all pairs, whether or not the teeth themselves are coupled. Without terms
    the problem is returned as it is.
    """
    if not model.compliances:
        return problem
    slices = problem.candidates.slices
    touch, face = slices.touch, slices.face_position
    roll_1, roll_2 = rolls_at(pair, touch.s_1, touch.s_2)
    added = sum(term(pair, roll_1, roll_2, face) for term in model.compliances)
    return replace(problem, compliance=problem.compliance + added)
