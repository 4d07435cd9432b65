"""Monotonicity of the transmission error in the load, from no load on.

Axes: T base pitches of the cycle, P positions in each.
"""

from __future__ import annotations

import numpy as np

from fe_contact.analysis.cycle.envelope import Envelope
from fe_contact.analysis.cycle.tangents import ToothGaps
from fe_contact.types import FloatArray

_MIN_COMPLIANCE = 0.1
"""Least compliance between neighboring loads over the smallest stored tangent compliance. It keeps the
transmission error rising with load.
"""


def rising_deflection(
    envelope: Envelope, support_envelope: Envelope
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Return the transmission error (T, P, ...) without load, at the loads, and at the support loads, m.

    In pitches that were not solved, curves at support loads that cross those at loads of the table are moved
    just clear of them. None if the curves at the loads of the table do not rise with load.
    """
    loads, support = envelope.contact.load, support_envelope.contact.load
    force = np.concatenate([[0.0], loads, support])
    no_load, requested, supporting = 0, 1, 2
    kind = np.repeat([no_load, requested, supporting], [1, loads.size, support.size])
    order = np.argsort(force)
    unloaded = _unloaded(envelope)
    levels = np.concatenate([unloaded[..., None], envelope.ste, support_envelope.ste], axis=2)[..., order]
    tangents = [
        part.arrays["tangent_compliance"].min()
        for part in (envelope, support_envelope)
        if part.contact.load.size
    ]
    step = _MIN_COMPLIANCE * min(tangents) * np.diff(force[order])
    tables = np.flatnonzero(kind[order] == requested)
    rising = levels.copy()
    for k in range(tables[0] - 1, -1, -1):
        rising[..., k] = np.minimum(rising[..., k], rising[..., k + 1] - step[k])
    for k in range(tables[0] + 1, order.size):
        if kind[order[k]] == supporting:
            rising[..., k] = np.maximum(rising[..., k], rising[..., k - 1] + step[k - 1])
    if not np.all(np.diff(rising, axis=2) > 0.0):
        return None
    rising = np.where(envelope.solved[:, None, None], levels, rising)
    back = rising[..., np.argsort(order)]
    return back[..., 0], back[..., 1 : 1 + loads.size], back[..., 1 + loads.size :]


def _unloaded(envelope: Envelope) -> FloatArray:
    """Return the transmission error without load (T, P), m: in most pitches the least gap of their teeth.

    Flanks that slope touch a little beside the point of that gap. The mean error by this over the pitches
    that are solved is subtracted.
    """
    contact = envelope.contact
    model, gaps = contact.point.model, envelope.gaps
    _, nominal = contact.nominal()
    plain = nominal.problem.candidates.gap
    by_pair = np.transpose(plain.reshape(len(plain), gaps.pair.size, -1), (1, 0, 2))  # (pairs, P, slices)
    gap = np.empty((model.period, len(plain)))
    for pitch in range(model.period):
        gap[pitch] = _least_gap(by_pair, gaps, pitch)
    exact = envelope.arrays["no_load"][1:, :, 0]
    error = (gap[envelope.pitches] - exact).mean(axis=0)
    return envelope.exact_in(gap - error, exact)


def _least_gap(plain: FloatArray, gaps: ToothGaps, pitch: int) -> FloatArray:
    """Return the least gap (P,) of the teeth that meet in a base pitch, m."""
    first, second = (teeth[0] for teeth in gaps.teeth(np.array([pitch])))
    pairs = np.arange(gaps.pair.size)
    return np.asarray(
        (plain + gaps.gears[0][pairs, :, first] + gaps.gears[1][pairs, :, second]).min(axis=(0, 2))
    )
