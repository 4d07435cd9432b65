"""How large the ripple of the transmission error will be beside its mean, before anything is computed.

Errors of meshes and slices are parts of the mean transmission error; asked for is a part of peak-to-peak,
which may be half of the mean or a thirtieth. Uncoupled slices tell which in hundredths of a second. Without
the coupling of the teeth they overstate it by 0.85 to 2 times on the cases of docs/accuracy.md, most where it
is small.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.analysis.request import Checked
from fe_contact.analysis.slice_laws import parabolic_stiffness
from fe_contact.analysis.slice_springs import SliceLaw, SpringContact
from fe_contact.analysis.table_places import table_places
from fe_contact.planning import Ripple, make_plan
from fe_contact.sampled import ALIGNMENTS, LOADS, sample_of
from fe_contact.types import FloatArray

LAW = SliceLaw(parabolic_stiffness, with_gaps=True)
POSITIONS = 32
COUPLED_LEAST, COUPLED_MOST = 0.65, 0.8
"""Ripple of coupled teeth over that of uncoupled slices, taken for the least and for the most of a table."""


def expected_ripple(checked: Checked) -> Ripple | None:
    """Solve some loads and alignments of a request by thin slices, in its first base pitch.

    Where the tolerance has a floor, the least counts as the size below which the floor holds.

    None for internal pairs, which the stiffness of the slices does not know, and where shafts couple them.
    """
    request, model = checked.request, checked.model
    if request.pair.internal or model.compliances:
        return None
    plan, allowed = make_plan(request.pair, request.load, request.accuracy, model), request.accuracy.allowed
    scene = replace(
        request.scene,
        misalignment=_some(request.misalignment, ALIGNMENTS),
        center_distance_change=_some(request.center_distance_change, ALIGNMENTS),
    )
    places = table_places(scene, checked.decided, SpringContact(request.pair, plan, law=LAW)).places
    position, load = np.arange(POSITIONS) / POSITIONS, _some(request.load, LOADS)
    solved = [place.solve(position, load)[1] for place in places]
    # errors grow with what the load adds: a misaligned pair leads at no load
    added = np.stack([np.mean(one.deflection - one.no_load[:, None], axis=0) for one in solved])
    ripple = np.stack([np.ptp(one.deflection, axis=0) for one in solved])
    least, most = allowed.scale(COUPLED_LEAST * ripple) / added, COUPLED_MOST * ripple / added
    return Ripple(float(least.min()), float(most.max()))


def _some(axis: FloatArray, most: int) -> FloatArray:
    """Return some nodes of an axis."""
    return axis[sample_of(axis.size, most)]
