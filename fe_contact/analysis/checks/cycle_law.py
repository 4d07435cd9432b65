"""The lifting law on a cycle: deviations of single teeth move the curve no further than they reach."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.analysis.checks.law import Law, LawCheck
from fe_contact.analysis.cycle.envelope import CycleContact
from fe_contact.contact.single_pair import single_pair_deflection
from fe_contact.types import FloatArray

_LIFTING = Law("lifting by single teeth", "transmission error less that of gears alike", "µm", 1e6)


def check_cycle(contact: CycleContact, ste: FloatArray, error: FloatArray) -> LawCheck:
    """Hold a cycle (T, P, L) in m against the gears without deviations of single teeth.

    It lies between theirs plus the least and plus the largest deviation of the teeth in mesh, and by how much
    one pair alone gives way under the whole load, since forces come to lie elsewhere.

    Parameters
    ----------
    error : ndarray, shape (L,)
        Of a pitch that was not solved, m.
    """
    pair, pitches = contact.point.contact.pair, np.arange(contact.pitches)
    _, alike = contact.nominal()
    meeting = pitches[:, None] - np.unique(alike.problem.candidates.pair)
    extent = replace(contact.point.model, gaps=()).extent(pair, meeting)
    low, high = np.min(extent.low, axis=1), np.max(extent.high, axis=1)
    alone = single_pair_deflection(pair, alike.problem, contact.load)
    alone = np.where(np.isfinite(alone), alone, alike.solution.deflection)
    room = alone + error

    def location(pitch: int, position: int, load: int) -> str:
        at = pitch + contact.position[position]
        return f"position {at:.6g}, force {contact.load[load]:.6g} N"

    change = ste - alike.solution.deflection
    return _LIFTING.between(change, low[:, None, None] - room, high[:, None, None] + room, location)
