"""Positions of the database: equally spaced, or denser where the curves bend."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fe_contact.planning import NodeRule
from fe_contact.ste.interpolation import Axis, interpolate
from fe_contact.types import BoolArray, FloatArray

MAX_ROUNDS = 10
PROBES = np.array([0.25, 0.5, 0.75])
"""Points of every interval where the interpolant is held against a solution; the middle becomes a node."""


@dataclass(frozen=True)
class PositionNodes:
    """Nodes over one base pitch with the interpolation error between them.

    Attributes
    ----------
    position : ndarray, shape (P,)
        Increasing in [0, 1).
    interval_error : ndarray, shape (P, L)
        Difference in m between interpolant and solution in the interval after each node, at the worst probe;
        (T P, L) where it is known for each of T base pitches. NaN where it was not requested.
    value, middle : ndarray, shapes (P, L) or (T P, L)
        STE in m at the nodes and in the middle of the interval after each.
    """

    position: FloatArray
    interval_error: FloatArray
    value: FloatArray
    middle: FloatArray

    @property
    def error(self) -> FloatArray:
        """Largest error beside each node, m; shape of `interval_error`."""
        return np.maximum(self.interval_error, np.roll(self.interval_error, 1, axis=0))


def unmeasured_nodes(count: int, columns: int) -> PositionNodes:
    """`count` equally spaced nodes between which nothing is measured, for L columns of curves."""
    unknown = np.full((count, columns), np.nan)
    return PositionNodes(np.arange(count) / count, unknown, unknown, unknown)


def adaptive_nodes(rule: NodeRule, solve: Callable[[FloatArray], FloatArray]) -> PositionNodes:
    """Bisect the intervals in which the interpolant misses a probe.

    Parameters
    ----------
    rule : NodeRule
        Nodes to begin with, largest error, largest number.
    solve : callable
        Positions (P,) to STE (W, P, L) in m: of one base pitch that repeats (W = 1), or of one with the pitch
        before and the pitch after it (W = 3).

    Notes
    -----
    The slope of STE jumps where a pair comes into contact, at a position that moves with load, so a few
    hundred nodes gather at the handovers. The search ends with the tolerance met, after `MAX_ROUNDS`, or at
    the largest number; the error says which.
    """
    nodes = np.arange(rule.start) / rule.start
    values = solve(nodes)
    settled = np.zeros(rule.start, dtype=bool)
    error, between = np.full(values.shape[1:], np.inf), np.zeros_like(values)
    for remaining in reversed(range(MAX_ROUNDS)):
        own = values[values.shape[0] // 2]
        allowed = rule.tolerance * rule.ripple(own)
        middles, at_middle, probed = _probed(nodes, values, solve, ~settled, PROBES)
        error[~settled], between[:, ~settled] = probed[~settled], at_middle[:, ~settled]
        missed = np.any(error > allowed, axis=1)
        if not missed.any() or not remaining or nodes.size + missed.sum() > rule.most:
            break
        nodes, values, settled, error, between = _inserted(nodes, values, missed, middles, between, error)
    own = values.shape[0] // 2
    return PositionNodes(nodes, error, values[own], between[own])


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
    own = solved[solved.shape[0] // 2]
    missed = np.abs(_interpolated(nodes, values, where.ravel()) - own).reshape(*where.shape, -1)
    at_middle, error = np.zeros_like(values), np.zeros(values.shape[1:])
    at_middle[:, open_] = solved.reshape(solved.shape[0], *where.shape, -1)[:, :, probes.size // 2]
    error[open_] = missed.max(axis=1)
    return nodes + 0.5 * spacing, at_middle, error


def _interpolated(nodes: FloatArray, values: FloatArray, where: FloatArray) -> FloatArray:
    """Interpolant (Q, L) of the middle one of W base pitches, at `where` in [0, 1]; all of them repeat."""
    pitches = np.arange(values.shape[0]) - values.shape[0] // 2
    knots = (pitches[:, None] + nodes).ravel()
    return interpolate(Axis(knots, float(pitches.size)), values.reshape(knots.size, -1), where)


def _inserted(
    nodes: FloatArray,
    values: FloatArray,
    missed: BoolArray,
    middles: FloatArray,
    at_middle: FloatArray,
    error: FloatArray,
) -> tuple[FloatArray, FloatArray, BoolArray, FloatArray, FloatArray]:
    """Insert the middles of the missed intervals; both halves and the neighbors are measured again."""
    touched = missed | np.roll(missed, 1) | np.roll(missed, -1)
    order = np.argsort(np.concatenate([nodes, middles[missed]]), kind="stable")
    merged = np.concatenate([nodes, middles[missed]])[order]
    return (
        merged,
        np.concatenate([values, at_middle[:, missed]], axis=1)[:, order],
        np.concatenate([~touched, np.zeros(int(missed.sum()), dtype=bool)])[order],
        np.concatenate([error, np.full((int(missed.sum()), error.shape[1]), np.inf)])[order],
        np.concatenate([at_middle, np.zeros_like(at_middle[:, missed])], axis=1)[:, order],
    )
