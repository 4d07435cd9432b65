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


@dataclass(frozen=True)
class PositionNodes:
    """Nodes over one base pitch with the interpolation error between them.

    Attributes
    ----------
    position : ndarray, shape (P,)
        Increasing in [0, 1).
    interval_error : ndarray, shape (P, L)
        Difference in m between interpolant and solution at the middle of the interval after each node.
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
    return PositionNodes(nodes, _middle_error(nodes, solve(nodes), solve)[1])


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
    """Bisect the intervals whose middle the interpolant misses.

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
    `MAX_NODES`; the error says which.
    """
    nodes = np.arange(rule.start) / rule.start
    values = solve(nodes)
    settled = np.zeros(rule.start, dtype=bool)
    error = np.full_like(values, np.inf)
    for remaining in reversed(range(MAX_ROUNDS)):
        allowed = np.maximum(rule.tolerance * np.ptp(values, axis=0), 1e-6 * np.abs(values).max(axis=0))
        middles, error, found = _middle_error(nodes, values, solve, settled, error)
        missed = np.any(error > allowed, axis=1)
        if not missed.any() or not remaining or nodes.size + missed.sum() > rule.most:
            break
        nodes, values, settled, error = _inserted(nodes, values, missed, middles, found, error)
    return PositionNodes(nodes, error)


def _middle_error(
    nodes: FloatArray,
    values: FloatArray,
    solve: Callable[[FloatArray], FloatArray],
    settled: BoolArray | None = None,
    known: FloatArray | None = None,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Middles, errors and solutions there, of the intervals not yet settled."""
    axis = Axis(nodes, 1.0)
    middles = nodes + 0.5 * axis.spacing
    open_ = np.ones(nodes.size, dtype=bool) if settled is None else ~settled
    error = np.zeros_like(values) if known is None else known.copy()
    found = np.zeros_like(values)
    found[open_] = solve(middles[open_])
    error[open_] = np.abs(interpolate(axis, values, middles[open_]) - found[open_])
    return middles, error, found


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
