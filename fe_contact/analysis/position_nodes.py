"""Positions of the database: equally spaced, or denser where the curves bend.

A node is a position at which the table is solved; between nodes curves are interpolated. Probes are further
solved positions that measure the error of interpolation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

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
    """`value`, `middle`: STE in m at the nodes and in the middle of the interval after each. Ndarray, shapes
    (P, L) or (T P, L).
    """

    @property
    def error(self) -> FloatArray:
        """Largest error near each node, m; shape of `interval_error`."""
        return np.maximum(self.interval_error, np.roll(self.interval_error, 1, axis=0))


def unmeasured_nodes(count: int, columns: int) -> PositionNodes:
    """`count` equally spaced nodes between which nothing is measured, for L columns of curves."""
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
    settled = np.zeros(rule.start, dtype=bool)
    error, between = np.full(values.shape[1:], np.inf), np.zeros_like(values)
    for remaining in reversed(range(MAX_ROUNDS)):
        nominal = values[values.shape[0] // 2]
        allowed = rule.tolerance * rule.ripple(nominal)
        middles, at_middle, probed = _probed(nodes, values, solve, ~settled, PROBES)
        error[~settled], between[:, ~settled] = probed[~settled], at_middle[:, ~settled]
        beyond = np.any(error > allowed, axis=1)
        if not beyond.any() or not remaining or nodes.size + beyond.sum() > rule.maximum:
            break
        nodes, values, settled, error, between = _inserted(nodes, values, beyond, middles, between, error)
    nominal = values.shape[0] // 2
    return PositionNodes(nodes, error, values[nominal], between[nominal])


def _probed(
    nodes: FloatArray,
    values: FloatArray,
    solve: Callable[[FloatArray], FloatArray],
    open_: BoolArray,
    probes: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Middles, solutions there, and largest errors at the probes, of the open intervals (others zero)."""
    spacing = Axis(nodes, 1.0).spacing
    where = nodes[open_, None] + spacing[open_, None] * probes
    solved = solve(where.ravel())
    nominal = solved[solved.shape[0] // 2]
    deviation = np.abs(_interpolated(nodes, values, where.ravel()) - nominal).reshape(*where.shape, -1)
    at_middle, error = np.zeros_like(values), np.zeros(values.shape[1:])
    at_middle[:, open_] = solved.reshape(solved.shape[0], *where.shape, -1)[:, :, probes.size // 2]
    error[open_] = deviation.max(axis=1)
    return nodes + 0.5 * spacing, at_middle, error


def _interpolated(nodes: FloatArray, values: FloatArray, where: FloatArray) -> FloatArray:
    """Interpolant (Q, L) of the middle one of W base pitches, at `where` in [0, 1]; all of them repeat."""
    pitches = np.arange(values.shape[0]) - values.shape[0] // 2
    knots = (pitches[:, None] + nodes).ravel()
    return interpolate(Axis(knots, float(pitches.size)), values.reshape(knots.size, -1), where)


def _inserted(
    nodes: FloatArray,
    values: FloatArray,
    beyond: BoolArray,
    middles: FloatArray,
    at_middle: FloatArray,
    error: FloatArray,
) -> tuple[FloatArray, FloatArray, BoolArray, FloatArray, FloatArray]:
    """Insert the middles of the missed intervals; both halves and the neighbors are measured again."""
    touched = beyond | np.roll(beyond, 1) | np.roll(beyond, -1)
    order = np.argsort(np.concatenate([nodes, middles[beyond]]), kind="stable")
    merged = np.concatenate([nodes, middles[beyond]])[order]
    return (
        merged,
        np.concatenate([values, at_middle[:, beyond]], axis=1)[:, order],
        np.concatenate([~touched, np.zeros(int(beyond.sum()), dtype=bool)])[order],
        np.concatenate([error, np.full((int(beyond.sum()), error.shape[1]), np.inf)])[order],
        np.concatenate([at_middle, np.zeros_like(at_middle[:, beyond])], axis=1)[:, order],
    )


def table_nodes(points: OperatingPoints, plan: Plan, report: Report = unreported) -> PositionNodes:
    """Place the positions: the number requested, or where the assessed curves bend.

    What is missed between fixed ones is not measured here (`position_errors`). `report` is called with the
    fraction of the positions that a search usually tries.
    """
    if plan.positions is not None:
        return unmeasured_nodes(plan.positions, len(points.assessed) * plan.load.size)
    pitches = assessed_pitches(points.nominal.pair, points.places[0].model, plan.nodes.assessed_pitches)
    times = points.period * len(points.places)
    tried, expected = 0, expected_tries(points.nominal.pair, plan, points.period, len(points.places))

    def solve(position: FloatArray) -> FloatArray:
        """STE (W, P, pitches x places x L) in m; beside the pitches NaN where interpolants do not reach."""
        nonlocal tried
        curves = _curves(points, plan.load, position, pitches)
        tried += position.size
        report(min(tried / expected, 1.0))
        if points.period == 1:
            return curves
        near = plan.nodes.reached_by_neighbor(position)
        values = np.full((3, *curves.shape[1:]), np.nan)
        values[1] = curves[0]
        for way in (-1, 1) if near.any() else ():
            values[1 + way, near] = _curves(points, plan.load, position[near], pitches + way)[0]
        return values

    return adaptive_nodes(replace(plan.nodes, maximum=max_positions(plan, times)), solve)


def assessed_pitches(pair: ParallelAxes, model: ContactModel, limit: int) -> IntArray:
    """Return base pitches to assess.

    Where all teeth are alike, the one pitch there is. Else pitches m, at most `limit`, evenly taken from all
    in the order of how much the gaps of the pairs at m - 1, m, m + 1 differ, both ends among them: these
    differences move and steepen the handovers.
    """
    if model.period == 1:
        return np.zeros(1, dtype=np.int64)
    meeting = np.arange(model.period)[:, None] + np.arange(-1, 2)
    spread = np.ptp(model.gap_of_teeth(MeetingTeeth.at_pitch_point(pair, meeting)), axis=1)
    order = np.argsort(spread, kind="stable")
    chosen = np.linspace(0, order.size - 1, min(limit, order.size)).astype(np.int64)
    return np.asarray(order[np.unique(chosen)])


def _curves(points: OperatingPoints, load: FloatArray, position: FloatArray, pitches: IntArray) -> FloatArray:
    """STE (1, P, pitches x places x L) in m of the assessed operating points in pitches (T,)."""
    curves = deflected_operating_points(
        points.assessed, [position] * len(points.assessed), load, pitches, points.workers
    )
    shape = (pitches.size, position.size, -1)
    by_pitch = np.concatenate([curve[..., 0].reshape(shape) for curve in curves], axis=2)
    return np.concatenate(np.split(by_pitch, pitches.size), axis=2)
