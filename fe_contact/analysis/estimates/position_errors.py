"""Errors of a table between its positions, at every point and in its curves.

Where an adaptive search placed the positions, the middles of all intervals are solved already. Where the
positions are fixed, middles are solved only in intervals in which the curve bends: first every position is
predicted from the others, and where the prediction hardly fails, a quarter of its failure is the error of the
interval, by second order at half the spacing.

Shapes: T = `period` base pitches (pitch deviations make them differ), P positions in a base pitch, Q others,
K = T P knots of the closed curve, F loads, C curves (operating points times loads), 23 figures of a curve
(`QUANTITIES`: mean, peak-to-peak, harmonics).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.pairs.contact_lines import deflected_operating_points
from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.analysis.position_nodes import PositionNodes
from fe_contact.contact import ContactSolution
from fe_contact.planning.plan import NodeRule, Plan
from fe_contact.sampled import sample_of, spread
from fe_contact.ste.curve_quantities import (
    OFF_MESH,
    PEAK_TO_PEAK,
    QUANTITIES,
    error_bound,
    peak_excess,
    quantity_changes,
)
from fe_contact.ste.interpolation import Axis, interpolate
from fe_contact.types import FloatArray, IntArray

LEFT_BY_MIDDLES = 1.5
"""Error of the positions over the change by inserting the middles of their intervals.

It is 4/3 for second order, and more for kinks, which may lie anywhere in an interval. Peaks where one tooth
pair hands over to the next fall with the first power of the spacing only; `peak_excess` bounds them
separately by the chords of the neighboring intervals.
"""
LOADS = 7
"""Loads of a table at which middles are solved: peaks between positions come and go from load to load."""
SOLVED_PART = 4
"""Divisor of the number of bending intervals between fixed positions: at most one in `SOLVED_PART` is solved.
"""
NEXT_SPACING = 0.25
"""Error at half the spacing over that at the spacing: second order."""


@dataclass(frozen=True)
class PositionErrors:
    """Errors for lack of positions, the largest of the assessed operating points at each load."""

    band: FloatArray
    """Largest error near each position of all base pitches, m. Shape (T P, F)."""
    curves: FloatArray
    """Errors of mean, peak-to-peak and harmonics, m. Shape (23, F)."""


def position_errors(
    nodes: PositionNodes, points: OperatingPoints, solutions: list[ContactSolution], plan: Plan
) -> PositionErrors:
    """Assess the positions of a table.

    Parameters
    ----------
    nodes : PositionNodes
        Positions with the errors of the search; errors of fixed positions, and of tables of several base
        pitches, are measured here.
    solutions : list of ContactSolution
        Solutions at all operating points.
    plan : Plan
        Its loads are used, and the error that a search by its rule would allow.
    """
    load, period = plan.load, points.period
    if np.isfinite(nodes.interval_error).any() and period == 1:
        return _position_errors(nodes, _by_middles(nodes, 1), load.size)
    sample = sample_of(load.size, LOADS)
    measured, left = _measured(nodes.position, points, solutions, plan, sample)
    bound = _bound(measured, left, period)
    if period > 1:
        bound[OFF_MESH] = _bound(measured, _left_of_difference(measured, left, period), period)[OFF_MESH]
    curves = _by_middles(measured, period) + bound
    errors = _position_errors(measured, curves, sample.size)
    return PositionErrors(spread(load, sample, errors.band, 1), spread(load, sample, errors.curves, 1))


def _bound(nodes: PositionNodes, left: FloatArray, period: int) -> FloatArray:
    """Return the errors of the figures of curves (23, C), m, by errors `left` (T P, C) of intervals.

    Interval k lies between nodes k and k + 1.
    """
    band = np.maximum(left, np.roll(left, 1, axis=0))
    return error_bound(_knots(nodes, period), band, nodes.value, period)


def _left_of_difference(nodes: PositionNodes, left: FloatArray, period: int) -> FloatArray:
    """Return the errors (T P, C), m, of the differences of base pitches from their mean.

    The differences alone give orders off the mesh orders.
    """
    by_pitch = nodes.value.reshape(period, nodes.position.size, -1)
    difference = (by_pitch - by_pitch.mean(axis=0)).reshape(left.shape)
    failed = NEXT_SPACING * predicted_failure(Axis(_knots(nodes, period), float(period)), difference)
    return np.where(left > 0.0, np.maximum(failed, np.roll(failed, -1, axis=0)), 0.0)


def _measured(
    position: FloatArray,
    points: OperatingPoints,
    solutions: list[ContactSolution],
    plan: Plan,
    sample: IntArray,
) -> tuple[PositionNodes, FloatArray]:
    """Solve middles of intervals at a `sample` of the loads, in all base pitches; see `measured_nodes`."""
    assessed, pitches = points.assessed_indices, np.arange(points.period)
    value = np.concatenate([solutions[k].deflection[:, sample] for k in assessed], axis=1)

    def solve(middles: FloatArray) -> FloatArray:
        curves = deflected_operating_points(
            points.assessed, [middles] * len(assessed), plan.load[sample], pitches, points.workers
        )
        return np.concatenate([curve[..., 0] for curve in curves], axis=1)

    return measured_nodes(position, value, solve, points.period, plan.nodes)


def measured_nodes(
    position: FloatArray,
    value: FloatArray,
    solve: Callable[[FloatArray], FloatArray],
    period: int,
    rule: NodeRule,
) -> tuple[PositionNodes, FloatArray]:
    """Measure the error between positions where it is largest, and bound it at the others.

    `value` (T P, C) is the STE in m at `position` (P,) in each of T = `period` base pitches, and `solve`
    gives it (T Q, C) at positions (Q,). An interval whose predicted error is less than a search by `rule`
    would allow is not solved: its middle is that of the interpolant. Its predicted error is returned beside
    the nodes, in an array (T P, C) in m that is 0 for solved intervals.
    """
    count = position.size
    axis = Axis((np.arange(period)[:, None] + position).ravel(), float(period))
    middle = axis.knots + 0.5 * axis.spacing
    between = interpolate(axis, value, middle)
    failed = NEXT_SPACING * predicted_failure(axis, value)
    error = np.maximum(failed, np.roll(failed, -1, axis=0))
    left = error.copy()
    # the largest error over the ripple of its curve; 0/0 of a curve without ripple counts as 0
    worst = np.nan_to_num(error / rule.ripple(value)).max(axis=1).reshape(period, count).max(axis=0)
    solved = np.argsort(worst, kind="stable")[
        -max(count // SOLVED_PART, 1) :
    ]  # the intervals of largest error
    solved = np.sort(solved[worst[solved] > rule.tolerance])
    if solved.size:
        rows = (np.arange(period)[:, None] * count + solved).ravel()
        solution = solve(middle[solved])
        error[rows], left[rows] = np.abs(between[rows] - solution), 0.0
        between[rows] = solution
    return PositionNodes(position, error, value, between), left


def predicted_failure(axis: Axis, value: FloatArray) -> FloatArray:
    """Return the differences of values (K, C) at the knots of a closed axis from predicted ones, m.

    Every second knot is predicted from the rest, then the rest from those.
    """
    failed = np.zeros_like(value)
    for first in (0, 1):
        nodes, left = np.arange(first, axis.knots.size, 2), np.arange(1 - first, axis.knots.size, 2)
        predicted = interpolate(Axis(axis.knots[nodes], axis.period), value[nodes], axis.knots[left])
        failed[left] = np.abs(predicted - value[left])
    return failed


def _by_middles(nodes: PositionNodes, period: int) -> FloatArray:
    """Return the errors of the figures of curves (23, C), m, by what inserting the middles changes."""
    knots = _knots(nodes, period)
    axis = np.append(knots, period)
    everywhere = np.sort(np.concatenate([knots, 0.5 * (axis[1:] + axis[:-1])]))
    both = np.stack([nodes.value, nodes.middle], axis=1).reshape(everywhere.size, -1)
    change = quantity_changes(knots, nodes.value, both, period, everywhere)
    ripple = np.ptp(both, axis=0) - np.ptp(nodes.value, axis=0) + peak_excess(everywhere, both, period)
    change *= LEFT_BY_MIDDLES
    change[PEAK_TO_PEAK] = ripple
    return change


def _position_errors(nodes: PositionNodes, curves: FloatArray, loads: int) -> PositionErrors:
    band: FloatArray = nodes.error.reshape(len(nodes.error), -1, loads).max(axis=1)
    worst: FloatArray = curves.reshape(QUANTITIES, -1, loads).max(axis=1)
    return PositionErrors(band, worst)


def _knots(nodes: PositionNodes, period: int) -> FloatArray:
    return (np.arange(period)[:, None] + nodes.position).ravel()
