"""Expected mean and ripple of the transmission error, before anything is computed.

Errors of meshes and slices are parts of the mean transmission error, but a tolerance is a part of
peak-to-peak, the ripple, which may be half of the mean or a thousandth of it. Uncoupled slices give both in
hundredths of a second. They lack the coupling of the teeth and the bodies: their mean is 0.55 to 0.94 of that
of finite elements (median 0.78), their ripple 0.8 to 1.4 of it where it is above 5 % of the mean
(docs/accuracy.md, "Plan").
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.analysis.pairs.operating_points import operating_points
from fe_contact.analysis.pairs.slice_springs import SliceLaw, SpringContact
from fe_contact.analysis.pairs.slice_stiffness import parabolic_stiffness
from fe_contact.analysis.request.request import Checked
from fe_contact.planning.expected_curves import ExpectedCurves
from fe_contact.sampled import ALIGNMENTS, LOADS, sample_of
from fe_contact.types import FloatArray

LAW = SliceLaw(parabolic_stiffness, with_gaps=True)

POSITIONS = 32

COUPLED_MEAN, COUPLED_RIPPLE = 1.3, 0.85
"""Mean under load and ripple of coupled teeth over those of uncoupled slices."""

UNSEEN_RIPPLE = 0.007
"""Ripple in parts of the mean that uncoupled slices do not see: they cancel where coupled teeth do not."""


def expected_curves(checked: Checked) -> ExpectedCurves | None:
    """Solve some loads and alignments of a request by thin slices, in its first base pitch.

    None for internal pairs, for which the slices have no stiffness, and where shafts couple the slices.
    """
    request, model = checked.request, checked.model
    if request.pair.internal or model.compliances:
        return None
    plan = checked.plan()
    scene = replace(
        request.scene,
        misalignment=_sampled(request.misalignment, ALIGNMENTS),
        center_distance_change=_sampled(request.center_distance_change, ALIGNMENTS),
    )
    points = operating_points(scene, checked.decision, SpringContact(request.pair, plan, law=LAW)).places
    position, load = np.arange(POSITIONS) / POSITIONS, _sampled(request.load, LOADS)
    solved = [solution for _, solution in (point.solve(position, load) for point in points)]
    # errors grow with what the load adds: a misaligned pair leads at no load
    unloaded = np.concatenate([np.full(load.size, np.mean(thin.no_load)) for thin in solved])
    added = COUPLED_MEAN * (np.concatenate([np.mean(thin.deflection, axis=0) for thin in solved]) - unloaded)
    slices = np.concatenate([np.ptp(thin.deflection, axis=0) for thin in solved])
    mean = np.abs(unloaded + added)
    ripple = np.hypot(COUPLED_RIPPLE * slices, UNSEEN_RIPPLE * added)
    return ExpectedCurves(np.tile(load, len(solved)), added, mean, ripple, request.options.allowed)


def _sampled(axis: FloatArray, limit: int) -> FloatArray:
    return axis[sample_of(axis.size, limit)]
