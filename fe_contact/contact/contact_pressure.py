"""Peak pressure of the contacts, from their loads and strips."""

from __future__ import annotations

import math

import numpy as np

from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.strip import Gap, gap_table, half_strip
from fe_contact.types import BoolArray, FloatArray
from host.loops import njit

_EDGE = 0.08
"""Least jump of slope at a break of the gap that is an edge: below any chamfer's, above any relief's."""


def contact_pressure(problem: ContactProblem, force: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return the peak pressure of each contact in Pa, and whether its strip reaches an edge, (P, L, n).

    It is 2 p/(pi h), the peak of an elliptic pressure over the strip 2 h of the true gap: Hertz's on a plain
    flank. Where a relief begins the pressure of a sharp kink is infinite at a point; this is the mean over
    the strip, times 4/pi. At the edge of a tip or of its chamfer the pressure is singular too; the result is
    Hertz's as if the flank went on, which only indicates how hard the edge presses. A rounded tip is part of
    the gap. `force`: normal forces, N.
    """
    candidates = problem.candidates
    loaded = np.nonzero(force.any(axis=1))
    gap, infinite = candidates.gap_at(loaded), np.full(loaded[0].size, np.inf)
    line_load = np.moveaxis(force, 1, 2)[loaded] / candidates.width[loaded][:, None]
    at_edge = (gap.low >= 0.0) | (gap.high <= 0.0)
    endless = _unchamfered_gap(gap)._replace(low=-infinite, high=infinite)
    endless = endless._replace(slope=np.where(at_edge, 0.0, endless.slope))
    half = _strips(gap_table(endless), line_load, problem.modulus)
    chamfer = np.where(gap.jump >= _EDGE, np.abs(gap.offset), np.inf).min(axis=-1, initial=np.inf)
    reach = np.minimum(np.minimum(-gap.low, gap.high), chamfer)[:, None]
    pressure, edge = np.zeros(force.shape), np.zeros(force.shape, dtype=np.bool_)
    row, contact = loaded
    pressure[row, :, contact] = np.divide(
        2.0 * line_load, math.pi * half, out=np.zeros(half.shape), where=half > 0.0
    )
    edge[row, :, contact] = half > reach
    return pressure, edge


def _unchamfered_gap(about: Gap) -> Gap:
    """Return the gaps as if flanks went on over their chamfers.

    Where the touching point is an edge, the gap has the slope and curvature to the left of it. There is
    either the chamfer, whose part is taken off, or the flank, with the chamfer to the right.
    """
    chamfer = about.jump >= _EDGE
    at_chamfer = chamfer & (about.offset == 0.0)
    to_the_left = at_chamfer & (about.slope[..., None] < -0.5 * about.jump)
    return about._replace(
        slope=np.where(at_chamfer.any(axis=-1), 0.0, about.slope),
        curvature=about.curvature + np.where(to_the_left, about.bend, 0.0).sum(axis=-1),
        jump=np.where(chamfer, 0.0, about.jump),
        bend=np.where(chamfer, 0.0, about.bend),
    )


@njit(cache=True)
def _strips(about: FloatArray, line_load: FloatArray, modulus: float) -> FloatArray:
    """Return half the strips of contacts (n,) under line loads (n, L) in N/m, zero where there is none, m."""
    half = np.zeros(line_load.shape)
    for i in range(line_load.shape[0]):
        for k in range(line_load.shape[1]):
            if line_load[i, k] > 0.0:
                half[i, k] = half_strip(about, i, line_load[i, k], modulus, 0.0, 0.0)[1]
    return half
