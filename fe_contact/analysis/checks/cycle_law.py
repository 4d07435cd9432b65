"""The lifting law on a hunting cycle: deviations of single teeth bound how far they move the curve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.analysis.checks.law import Law, LawCheck
from fe_contact.analysis.cycle.envelope import CycleContact
from fe_contact.contact.single_pair import single_pair_deflection
from fe_contact.types import FloatArray

_LIFTING = Law("lifting by single teeth", "transmission error less that of gears alike", "µm", 1e6)


def check_cycle(contact: CycleContact, ste: FloatArray, error: FloatArray) -> LawCheck:
    """Check the curve `ste` (T, P, L) of a cycle in m against that of gears without deviations of teeth.

    The change by the deviations is at least the least and at most the largest deviation of the teeth in mesh.
    To both sides it may exceed these by the deflection of one pair alone under the whole load, since the
    deviations redistribute the forces.

    Parameters
    ----------
    error : ndarray, shape (L,)
        Error of the curve in a pitch that was not solved, m.
    """
    pair, pitches = contact.point.contact.pair, np.arange(contact.pitches)
    _, alike = contact.nominal()
    meeting = pitches[:, None] - np.unique(alike.problem.candidates.pair)
    extent = replace(contact.point.model, gaps=()).extent(pair, meeting)
    low, high = np.min(extent.low, axis=1), np.max(extent.high, axis=1)
    alone = single_pair_deflection(pair, alike.problem, contact.load)
    alone = np.where(np.isfinite(alone), alone, alike.solution.deflection)
    margin = alone + error

    def location(pitch: int, position: int, load: int) -> str:
        at = pitch + contact.position[position]
        return f"position {at:.6g}, force {contact.load[load]:.6g} N"

    change = ste - alike.solution.deflection
    return _LIFTING.between(change, low[:, None, None] - margin, high[:, None, None] + margin, location)
