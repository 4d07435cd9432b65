"""Positions of the database: equally spaced, or denser where the curves bend.

A node is a position at which the table is solved; between nodes curves are interpolated. Probes are further
solved positions that measure the error of interpolation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from fe_contact.analysis.pairs.contact_lines import deflected_operating_points
from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.contact import ContactModel
from fe_contact.contact.model import MeetingTeeth
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.cost_model import expected_tries, max_positions
from fe_contact.planning.plan import NodeRule, Plan
from fe_contact.ste.interpolation import Axis, interpolate
from fe_contact.types import BoolArray, FloatArray, IntArray
from model_studies.progress import Report, unreported

MAX_ROUNDS = 10

PROBES = np.array([0.25, 0.5, 0.75])
"""Points of every interval at which the interpolant is compared with a solution; the middle becomes a node.
"""


@dataclass(frozen=True)
class PositionNodes:
    """Nodes over one base pitch with the interpolation error between them."""

    position: FloatArray
    """Increasing in [0, 1). Shape (P,)."""
    interval_error: FloatArray
    """Difference in m between interpolant and solution in the interval after each node, at the worst probe;
    (T P, L) where it is known for each of T base pitches. NaN where it was not requested. Shape (P, L).
    """
    value: FloatArray
    middle: FloatArray
    """`value`, `middle`: STE at the nodes and in the middle after each, m. Shape (P, L) or (T P, L) each."""

    @property
    def error(self) -> FloatArray:
        """Largest error near each node, m; shape of `interval_error`."""
        return np.maximum(self.interval_error, np.roll(self.interval_error, 1, axis=0))


def unmeasured_nodes(count: int, columns: int) -> PositionNodes:
    """Return equally spaced nodes between which nothing is measured, for L columns of curves."""
    unknown = np.full((count, columns), np.nan)
    return PositionNodes(np.arange(count) / count, unknown, unknown, unknown)


def adaptive_nodes(rule: NodeRule, solve: Callable[[FloatArray], FloatArray]) -> PositionNodes:
    """Bisect the intervals in which the interpolant misses a probe.

    `solve` gives the STE (W, P, L) in m at positions (P,): of one base pitch that repeats (W = 1), or of
    one with the pitch before and the pitch after it (W = 3).

    The slope of STE jumps where a pair comes into contact, at a position that moves with load, so a few
    hundred nodes gather at the handovers. The search ends with the tolerance met, after `MAX_ROUNDS`, or
    at the largest number; the error says which.
    """
    nodes = np.arange(rule.start) / rule.start
    values = solve(nodes)
    search = _Search(
        nodes=nodes,
        values=values,
        measured=np.zeros(rule.start, dtype=bool),
        error=np.full(values.shape[1:], np.inf),
        at_middle=np.zeros_like(values),
    )
    nominal = values.shape[0] // 2
    for remaining in reversed(range(MAX_ROUNDS)):
        allowed, unknown = rule.tolerance * rule.ripple(search.values[nominal]), ~search.measured
        middle, error = _probed(search.nodes, search.values, solve, unknown)
        search.at_middle[:, unknown], search.error[unknown] = middle, error
        beyond = np.any(search.error > allowed, axis=1)
        if not beyond.any() or not remaining or search.nodes.size + beyond.sum() > rule.maximum:
            break
        search = search.inserted(beyond)
    return PositionNodes(search.nodes, search.error, search.values[nominal], search.at_middle[nominal])


class _Search(NamedTuple):
    """Nodes (P,) of a search, STE (W, P, L) there, m, and what is known of the interval after each node."""

    nodes: FloatArray
    values: FloatArray
    measured: BoolArray
    """Whether the interval is still as measured. Shape (P,)."""
    error: FloatArray
    """Largest error of an interpolated STE in the interval, m. Shape (P, L)."""
    at_middle: FloatArray
    """STE in the middle of the interval, m. Shape (W, P, L)."""

    def inserted(self, beyond: BoolArray) -> _Search:
        """Insert the middles of the intervals that are `beyond` the tolerance.

        Both halves of an interval and its neighbors are measured again.
        """
        touched = beyond | np.roll(beyond, 1) | np.roll(beyond, -1)
        middles = (self.nodes + 0.5 * Axis(self.nodes, 1.0).spacing)[beyond]
        merged = np.concatenate([self.nodes, middles])
        order = np.argsort(merged, kind="stable")
        at_middle, unknown = self.at_middle, np.full((middles.size, self.error.shape[1]), np.inf)
        return _Search(
            nodes=merged[order],
            values=np.concatenate([self.values, at_middle[:, beyond]], axis=1)[:, order],
            measured=np.concatenate([~touched, np.zeros(middles.size, dtype=bool)])[order],
            error=np.concatenate([self.error, unknown])[order],
            at_middle=np.concatenate([at_middle, np.zeros_like(at_middle[:, beyond])], axis=1)[:, order],
        )


def _probed(
    nodes: FloatArray, values: FloatArray, solve: Callable[[FloatArray], FloatArray], chosen: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Return STE (W, c, L) in the middles of the c chosen intervals, and the largest errors (c, L) there."""
    position = nodes[chosen, None] + Axis(nodes, 1.0).spacing[chosen, None] * PROBES
    solved = solve(position.ravel())
    nominal = solved[solved.shape[0] // 2]
    deviation = np.abs(_interpolated(nodes, values, position.ravel()) - nominal).reshape(*position.shape, -1)
    by_interval = solved.reshape(solved.shape[0], *position.shape, -1)
    return by_interval[:, :, PROBES.size // 2], deviation.max(axis=1)


def _interpolated(nodes: FloatArray, values: FloatArray, position: FloatArray) -> FloatArray:
    """Interpolate the middle one of W base pitches at `where` (Q,) in [0, 1], (Q, L); all pitches repeat."""
    pitches = np.arange(values.shape[0]) - values.shape[0] // 2
    knots = (pitches[:, None] + nodes).ravel()
    return interpolate(Axis(knots, float(pitches.size)), values.reshape(knots.size, -1), position)


def table_nodes(points: OperatingPoints, plan: Plan, report: Report = unreported) -> PositionNodes:
    """Place the positions: the number requested, or where the assessed curves bend.

    The error between a requested number of positions is not measured here (`position_errors`). `report` is
    called with the fraction of the positions that a search usually tries.
    """
    if plan.positions is not None:
        return unmeasured_nodes(plan.positions, len(points.assessed) * plan.load.size)
    pitches = assessed_pitches(points.nominal.pair, points.places[0].model, plan.nodes.assessed_pitches)
    times = points.period * len(points.places)
    tried, expected = 0, expected_tries(points.nominal.pair, plan, points.period, len(points.places))

    def solve(position: FloatArray) -> FloatArray:
        """Return STE (W, P, pitches x places x L) in m; in the pitches beside NaN where none is needed."""
        nonlocal tried
        curves = _curves(points, plan.load, position, pitches)
        tried += position.size
        report(min(tried / expected, 1.0))
        if points.period == 1:
            return curves
        near = plan.nodes.reached_by_neighbor(position)
        values = np.full((3, *curves.shape[1:]), np.nan)  # the pitches before, the pitches, those after
        values[1] = curves[0]
        for step in (-1, 1) if near.any() else ():
            values[1 + step, near] = _curves(points, plan.load, position[near], pitches + step)[0]
        return values

    return adaptive_nodes(replace(plan.nodes, maximum=max_positions(plan, times)), solve)


def assessed_pitches(pair: ParallelAxes, model: ContactModel, limit: int) -> IntArray:
    """Return the base pitches to assess, at most `limit`; one where all teeth are alike.

    They are taken evenly from all pitches m in the order of how much the gaps of the pairs at m - 1, m, m + 1
    differ, with both ends of that order: these differences move and steepen the handovers.
    """
    if model.period == 1:
        return np.zeros(1, dtype=np.int64)
    meeting = np.arange(model.period)[:, None] + np.arange(-1, 2)
    spread = np.ptp(model.gap_of_teeth(MeetingTeeth.at_pitch_point(pair, meeting)), axis=1)
    order = np.argsort(spread, kind="stable")
    chosen = np.linspace(0, order.size - 1, min(limit, order.size)).astype(np.int64)
    return np.asarray(order[np.unique(chosen)])


def _curves(points: OperatingPoints, load: FloatArray, position: FloatArray, pitches: IntArray) -> FloatArray:
    """Return STE (1, P, pitches x places x L) in m of the assessed operating points in pitches (T,)."""
    curves = deflected_operating_points(
        points.assessed, [position] * len(points.assessed), load, pitches, points.workers
    )
    shape = (pitches.size, position.size, -1)
    by_pitch = np.concatenate([curve[..., 0].reshape(shape) for curve in curves], axis=2)
    return np.concatenate(np.split(by_pitch, pitches.size), axis=2)
