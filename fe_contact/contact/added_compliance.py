"""Compliance of what carries the gears, added to that of the teeth and bodies."""

from __future__ import annotations

from dataclasses import replace

from fe_contact.contact.model import ContactModel
from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.touch import rolls_at
from fe_contact.geometry import ParallelAxes


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
