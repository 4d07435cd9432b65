"""Bounds of the change of the transmission error between neighboring positions.

Where a pair carries, the transmission error follows its gap and its compliance. Its slope along the line of
action is at most the sum of three: the slope of the deviations, the rate at which the gap of a tip edge opens
while the edge may carry, and the rate at which the compliance of teeth grows towards their tips, times the
deflection. Rough flanks touch at one crest and then at the next: the curvature of the strip jumps there, and
its approach with it.
"""

from __future__ import annotations

import numpy as np

from fe_contact.analysis.pairs.operating_points import OperatingPoint
from fe_contact.contact import ContactProblem
from fe_contact.flank.extent import Extent
from fe_contact.geometry import ParallelAxes, Side, corner_contact
from fe_contact.types import FloatArray

_OVERSHOOTS = 129  # distances beyond the end of contact, over one base pitch
_SIDES: tuple[Side, Side] = ("approach", "exit")
ELASTIC = 2.0
"""Change of the transmission error over that of the deflection at constant forces: the forces change too, and
by as much again.
"""


def edge_slope(pair: ParallelAxes, level: FloatArray) -> FloatArray:
    """Return the largest slopes (...) of gaps of tip edges, m/m, while they are below levels (...) in m."""
    overshoot = np.linspace(0.0, pair.base_pitch, _OVERSHOOTS)
    slope = np.zeros(level.shape)
    for side in _SIDES:
        gap = corner_contact(pair, side, overshoot).gap
        can_touch = np.isfinite(gap)
        if np.count_nonzero(can_touch) < 2:
            continue
        opening = np.diff(gap[can_touch]) / np.diff(overshoot[can_touch])
        # the slope of the interval that holds the level, and the one before it: gaps are convex
        within = np.searchsorted(gap[can_touch], level).clip(1, opening.size) - 1
        slope = np.maximum(slope, np.maximum.accumulate(opening)[within])
    return np.asarray(slope)


def compliance_slope(problem: ContactProblem, base_pitch: float) -> float:
    """Return the largest relative change of a slice's compliance per length of the line of action, 1/m."""
    count = len(problem.compliance)
    position = problem.candidates.position[:count]
    slices = np.einsum("qii->qi", problem.compliance)
    present = problem.candidates.slices.present & (slices > 0.0)
    both = present[1:] & present[:-1]
    if count < 2 or not both.any():
        return np.inf
    way = base_pitch * np.diff(position)[:, None]
    change = np.abs(np.diff(slices, axis=0)) / np.minimum(slices[1:], slices[:-1]).clip(1e-300) / way
    return float(change[both].max())


def approach_steps(
    pair: ParallelAxes, problem: ContactProblem, positions: int, load: FloatArray
) -> FloatArray:
    """Return by how much the approach in a strip changes from each position to the next (P, L), m.

    Under a line load p it changes by p/(pi E*) times the logarithm of the ratio of the curvatures. One pair
    carries the loads (L,) in N over the face. Where base pitches follow from derivatives and have no touching
    points, all positions have the largest change.
    """
    touch = problem.candidates.touch
    curvature = np.where(np.isfinite(touch.gap), touch.curvature, np.nan)
    ratio = np.abs(np.log(np.roll(curvature, -1, axis=0) / curvature))
    change = np.nan_to_num(ratio).max(axis=1)
    if len(change) != positions:
        change = np.full(positions, change.max())
    return np.asarray(change[:, None] * load / (np.pi * problem.modulus * pair.face_width))


def largest_steps(
    point: OperatingPoint,
    problem: ContactProblem,
    way: FloatArray,
    deviations: Extent,
    deflection: FloatArray,
) -> FloatArray:
    """Return the largest change of a curve from each position to the next (P, L), m.

    Parameters
    ----------
    way : ndarray, shape (P,)
        Distance to the next position along the line of action, m.
    deviations : Extent
        Bounds of the deviations of the teeth in mesh, arrays (P,).
    deflection : ndarray, shape (L,)
        Largest transmission error of each load above the least gap, m.
    """
    pair = point.contact.pair
    low, high, slope = (np.asarray(bound) for bound in (deviations.low, deviations.high, deviations.slope))
    neighbors = [np.stack([bound, np.roll(bound, -1)]) for bound in (low, high, slope)]
    span = neighbors[1].max(axis=0) - neighbors[0].min(axis=0)
    by_deviations = np.minimum(neighbors[2].max(axis=0) * way, span)[:, None]
    edges = edge_slope(pair, deflection)
    elastic = ELASTIC * compliance_slope(problem, pair.base_pitch) * deflection
    return np.asarray(by_deviations + way[:, None] * (edges + elastic))
