"""Where the database has its positions: equally spaced, or denser where the curves bend."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.table_places import Places
from fe_contact.planning import NodeRule, Plan
from fe_contact.ste.interpolation import Axis, interpolate
from fe_contact.types import BoolArray, FloatArray

MAX_ROUNDS = 10
MIDDLE = np.array([0.5])
PROBES = np.array([0.25, 0.5, 0.75])
"""Where in every interval the interpolant is held against a solution; the middle one becomes a node."""


@dataclass(frozen=True)
class PositionNodes:
    """Nodes over one base pitch with the interpolation error between them.

    Attributes
    ----------
    position : ndarray, shape (P,)
        Increasing in [0, 1).
    interval_error : ndarray, shape (P, L)
        Difference in m between interpolant and solution in the interval after each node, at the worst probe.
    """

    position: FloatArray
    interval_error: FloatArray

    @property
    def error(self) -> FloatArray:
        """Largest error beside each node (P, L), m."""
        return np.maximum(self.interval_error, np.roll(self.interval_error, 1, axis=0))


def fixed_nodes(count: int, solve: Callable[[FloatArray], FloatArray]) -> PositionNodes:
    """`count` equally spaced nodes; the error is measured at the middles of all intervals."""
    nodes = np.arange(count) / count
    return PositionNodes(nodes, _probed(nodes, solve(nodes), solve, np.ones(count, dtype=bool), MIDDLE)[2])


def table_nodes(places: Places, plan: Plan) -> PositionNodes:
    """Place the positions of a table: the number asked for, or where the curves of its judged places bend."""

    def solve(position: FloatArray) -> FloatArray:
        """STE (P, places x L) in m."""
        curves = [place.solve(position, plan.load)[1].deflection for place in places.judged]
        return np.concatenate(curves, axis=1)

    if plan.positions is not None:
        return fixed_nodes(plan.positions, solve)
    return adaptive_nodes(plan.nodes, solve)


def adaptive_nodes(rule: NodeRule, solve: Callable[[FloatArray], FloatArray]) -> PositionNodes:
    """Bisect the intervals in which the interpolant misses a probe.

    Parameters
    ----------
    rule : NodeRule
        Nodes to begin with, largest error, largest number.
    solve : callable
        Positions (P,) to STE (P, L) in m.

    Notes
    -----
    The slope of STE jumps where a pair comes into contact, at a position that moves with load, so a few
    hundred nodes gather at the handovers. The search ends with the tolerance met, after `MAX_ROUNDS`, or at
    the largest number; the error says which.
    """
    nodes = np.arange(rule.start) / rule.start
    values = solve(nodes)
    settled = np.zeros(rule.start, dtype=bool)
    error = np.full_like(values, np.inf)
    for remaining in reversed(range(MAX_ROUNDS)):
        allowed = np.maximum(rule.tolerance * np.ptp(values, axis=0), 1e-6 * np.abs(values).max(axis=0))
        middles, found, probed = _probed(nodes, values, solve, ~settled, PROBES)
        error[~settled] = probed[~settled]
        missed = np.any(error > allowed, axis=1)
        if not missed.any() or not remaining or nodes.size + missed.sum() > rule.most:
            break
        nodes, values, settled, error = _inserted(nodes, values, missed, middles, found, error)
    return PositionNodes(nodes, error)


def _probed(
    nodes: FloatArray,
    values: FloatArray,
    solve: Callable[[FloatArray], FloatArray],
    open_: BoolArray,
    probes: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Middles, solutions there, and largest errors at the probes, of the open intervals (others zero)."""
    axis = Axis(nodes, 1.0)
    where = nodes[open_, None] + axis.spacing[open_, None] * probes
    solved = solve(where.ravel())
    missed = np.abs(interpolate(axis, values, where.ravel()) - solved).reshape(*where.shape, -1)
    found, error = np.zeros((2, *values.shape))
    found[open_] = solved.reshape(*where.shape, -1)[:, probes.size // 2]
    error[open_] = missed.max(axis=1)
    return nodes + 0.5 * axis.spacing, found, error


def _inserted(
    nodes: FloatArray,
    values: FloatArray,
    missed: BoolArray,
    middles: FloatArray,
    found: FloatArray,
    error: FloatArray,
) -> tuple[FloatArray, FloatArray, BoolArray, FloatArray]:
    """Insert the middles of the missed intervals; both halves and the neighbours are measured again."""
    touched = missed | np.roll(missed, 1) | np.roll(missed, -1)
    order = np.argsort(np.concatenate([nodes, middles[missed]]), kind="stable")
    merged = np.concatenate([nodes, middles[missed]])[order]
    return (
        merged,
        np.concatenate([values, found[missed]])[order],
        np.concatenate([~touched, np.zeros(int(missed.sum()), dtype=bool)])[order],
        np.concatenate([error, np.full((int(missed.sum()), values.shape[1]), np.inf)])[order],
    )
