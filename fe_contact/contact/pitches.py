"""The same positions in several base pitches: other teeth, hence other gaps, but the same compliance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.contact.model import ContactModel
from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.touch import Touch
from fe_contact.types import FloatArray, IntArray


def in_pitches(problem: ContactProblem, model: ContactModel, pitch: IntArray) -> ContactProblem:
    """Put the positions of a problem into whole base pitches, and add the gaps of the teeth that meet there.

    Parameters
    ----------
    problem : ContactProblem
        P positions in [0, 1), with all other gaps in it.
    model : ContactModel
        Its `tooth_gaps` are added.
    pitch : ndarray of int, shape (R,)
        Whole base pitches, R a multiple of P: row r is position r modulo P in this pitch.

    Returns
    -------
    ContactProblem
        R positions; its compliance stays that of the P positions.

    Notes
    -----
    Pair j of pitch m is the pair of teeth that meets (m - j)-th: one pitch later each pair has moved on to
    the place of the next one. The touching points stay those of perfect pitches: micrometers of rolling are
    nothing to the curvatures there.
    """
    candidates = problem.candidates
    times = pitch.size // candidates.position.size
    touch = _repeated(candidates.touch, times)
    if model.tooth_gaps:
        meeting = pitch[:, None] - candidates.pair
        touch = replace(touch, gap=touch.gap + sum(term(meeting) for term in model.tooth_gaps))
    moved = replace(
        candidates,
        position=np.tile(candidates.position, times) + pitch,
        touch=touch,
        width=np.concatenate([candidates.width] * times),
    )
    return problem.touching(moved)


def _repeated(touch: Touch, times: int) -> Touch:
    """Write arrays (P, m) or (P, m, B) out so many times, one below the other."""
    tiled: dict[str, FloatArray] = {
        name: np.concatenate([values] * times) for name, values in vars(touch).items()
    }
    return Touch(**tiled)
