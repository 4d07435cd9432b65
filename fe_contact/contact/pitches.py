"""The same positions in several base pitches: other teeth, hence other gaps, but the same compliance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.contact.model import ContactModel
from fe_contact.contact.plain_touch import Touch
from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.tooth_touch import tooth_touch
from fe_contact.contact.touch_cache import cached_touch
from fe_contact.geometry import ParallelAxes
from fe_contact.types import IntArray


def in_pitches(
    pair: ParallelAxes, problem: ContactProblem, model: ContactModel, pitch: IntArray
) -> ContactProblem:
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
    the place of the next one. Load patches stay those of perfect pitches: micrometers of rolling are nothing
    to the bodies.
    """
    candidates = problem.candidates
    times = pitch.size // candidates.position.size

    def find() -> Touch:
        tiled = (np.concatenate([values] * times) for values in vars(candidates.touch).values())
        touch = Touch(*tiled)
        if not model.tooth_gaps:
            return touch
        return tooth_touch(pair, touch, model, pitch[:, None] - candidates.pair, candidates.face_position)

    common = candidates.touch
    touch = cached_touch(
        (pair, model.gaps, model.tooth_gaps, model.corner_contact),
        (common.roll_1, common.s_1, common.gap, candidates.face_position, candidates.pair, pitch),
        find,
    )
    in_base_pitches = replace(
        candidates,
        position=np.tile(candidates.position, times) + pitch,
        touch=touch,
        width=np.concatenate([candidates.width] * times),
    )
    return problem.touching(in_base_pitches)
