"""What is said of the error between fixed positions is what there is, and little is solved for it."""

from __future__ import annotations

import numpy as np
import pytest

from fe_contact.analysis.estimates.position_errors import _measured_nodes, _predicted_failure
from fe_contact.analysis.tables import _adaptive_nodes
from fe_contact.planning.plan import NodeRule
from fe_contact.ste.interpolation import Axis, interpolate

TOLERANCE = 0.002
HEIGHT = np.array([1e-6, 3e-6])


def trapezoids(position: np.ndarray) -> np.ndarray:
    """Near-square waves with kinks at places no grid knows, one per load level."""
    phase = np.abs((position[:, None] + 0.5) % 1.0 - 0.5)
    return HEIGHT * (2.0 - np.clip((phase - np.array([0.2137, 0.2071])) / 0.03, 0.0, 1.0))


def waves(position: np.ndarray) -> np.ndarray:
    """Smooth curves."""
    return np.cos(2.0 * np.pi * (position[:, None] - 0.13)) * HEIGHT


def assessed(curves, count):
    """Errors beside each of `count` even positions, what was left unsolved, and how much was solved."""
    asked = []

    def solve(position):
        asked.append(position)
        return curves(position)

    nodes = np.arange(count) / count
    found, left = _measured_nodes(nodes, curves(nodes), solve, 1, NodeRule(count, TOLERANCE, 768))
    return found, left, sum(position.size for position in asked)


def missed(curves, count):
    """Largest error at many places, beside each of `count` even positions."""
    nodes, query = np.arange(count) / count, (np.arange(32 * count) + 0.5) / (32 * count)
    error = np.abs(interpolate(Axis(nodes, 1.0), curves(nodes), query) - curves(query))
    interval = error.reshape(count, 32, -1).max(axis=1)
    return np.maximum(interval, np.roll(interval, 1, axis=0))


@pytest.mark.parametrize("count", [32, 64, 65, 128])
def test_kinks_are_found_and_solved_where_they_are(count):
    found, left, solved = assessed(trapezoids, count)
    true = missed(trapezoids, count)
    assert 0 < solved <= count // 4
    # a kink is missed most anywhere in its interval, not at its middle
    assert np.all(found.error.max(axis=0) > 0.3 * true.max(axis=0))
    beside = true > 0.05 * true.max(axis=0)
    assert np.all((left[beside] == 0.0) | (found.error[beside] > 0.2 * true[beside]))
    assert np.all(found.error[true < 1e-6 * HEIGHT].max() < 0.02 * true.max())


@pytest.mark.parametrize("count", [64, 96])
def test_smooth_curves_are_assessed_without_a_solution(count):
    """Their error is what the cut of the slopes at the extrema leaves; it depends on where knots lie."""
    found, left, solved = assessed(waves, count)
    true = missed(waves, count)
    assert solved == 0
    assert np.array_equal(found.interval_error, left)
    assert np.all(found.error.max(axis=0) >= 0.25 * true.max(axis=0))
    assert np.all(found.error.max(axis=0) <= 4.0 * true.max(axis=0))


def test_the_prediction_fails_with_the_square_of_the_spacing_or_faster():
    few, many = (
        _predicted_failure(Axis(nodes, 1.0), waves(nodes)).max(axis=0)
        for nodes in (np.arange(n) / n for n in (32, 64))
    )
    assert np.all(many < 0.3 * few)
    even = np.arange(7) / 7  # an odd number closes with two neighbors of the same set
    assert _predicted_failure(Axis(even, 1.0), np.ones((7, 2))).max() < 1e-15


def test_fixed_positions_state_a_larger_error_than_placed_ones():
    placed = _adaptive_nodes(NodeRule(32, TOLERANCE, 768), lambda position: trapezoids(position)[None])
    assert np.all(assessed(trapezoids, 32)[0].error.max(axis=0) > placed.error.max(axis=0))
