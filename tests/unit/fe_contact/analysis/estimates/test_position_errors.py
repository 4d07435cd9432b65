"""Errors between positions: of fixed ones, told from half of them, and of those that gather at kinks."""

import numpy as np
import pytest

from fe_contact.analysis.estimates.half_position_errors import errors_by_halves
from fe_contact.analysis.estimates.position_errors import measured_nodes, predicted_failure
from fe_contact.analysis.position_nodes import adaptive_nodes
from fe_contact.planning.plan import NodeRule
from fe_contact.ste.curve_quantities import FIRST_HARMONIC, MEAN, PEAK_TO_PEAK, quantity_changes
from fe_contact.ste.interpolation import Axis, interpolate
from fe_contact.types import FloatArray

TOLERANCE = 0.002
SOME = [MEAN, PEAK_TO_PEAK, FIRST_HARMONIC]
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
    found, left = measured_nodes(nodes, curves(nodes), solve, 1, NodeRule(count, TOLERANCE, 768))
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
        predicted_failure(Axis(nodes, 1.0), waves(nodes)).max(axis=0)
        for nodes in (np.arange(n) / n for n in (32, 64))
    )
    assert np.all(many < 0.3 * few)
    even = np.arange(7) / 7  # an odd number closes with two neighbors of the same set
    assert predicted_failure(Axis(even, 1.0), np.ones((7, 2))).max() < 1e-15


def test_fixed_positions_state_a_larger_error_than_placed_ones():
    placed = adaptive_nodes(NodeRule(32, TOLERANCE, 768), lambda position: trapezoids(position)[None])
    assert np.all(assessed(trapezoids, 32)[0].error.max(axis=0) > placed.error.max(axis=0))


FINE = np.arange(8192) / 8192


def knots(count: int, period: int = 1) -> FloatArray:
    """Return even positions."""
    return np.arange(count * period) / count


def kinked(position: FloatArray) -> FloatArray:
    """Return a curve of straight lines with corners at odd places, one peak narrower than a sixteenth."""
    corners, heights = [0.0, 0.137, 0.411, 0.463, 0.871, 1.0], [1.0, 1.2, 1.1, 1.7, 0.6, 1.0]
    return np.interp(position % 1.0, corners, heights)[:, None]


def smooth(position: FloatArray) -> FloatArray:
    """Return a curve whose harmonics fall slowly."""
    turn = 2.0 * np.pi * position
    return (1.0 + 0.3 * np.cos(turn) / (1.3 - np.sin(turn + 0.4)))[:, None]


@pytest.mark.parametrize("count", [32, 64, 192])
def test_errors_hold_for_corners_wherever_they_stand(count):
    """Straight lines between corners at random places, a few positions apart: misses are few."""
    random, position, ratio = np.random.default_rng(7), knots(count), []
    for _ in range(60):
        corners = (np.arange(5) + 0.6 * random.random(5)) / 5.0
        heights = 1.0 + random.random(5)
        closed = np.concatenate([[corners[-1] - 1.0], corners, [corners[0] + 1.0]])
        around = np.concatenate([heights[-1:], heights, heights[:1]])
        values, true = (np.interp(where, closed, around)[:, None] for where in (position, FINE))
        change = quantity_changes(position, values, true, 1, FINE)[SOME, 0]
        ratio.append(errors_by_halves(position, values, 1).curves[SOME, 0] / np.maximum(change, 1e-9))
    held = np.mean(np.array(ratio) >= 1.0, axis=0)
    assert held.mean() >= 0.9
    assert np.median(ratio) < 6.0


@pytest.mark.parametrize("count", [16, 32, 64])
def test_errors_hold_for_a_smooth_curve(count):
    position, values = knots(count), smooth(knots(count))
    true = quantity_changes(position, values, smooth(FINE), 1, FINE)[SOME, 0]
    assert np.all(errors_by_halves(position, values, 1).curves[SOME, 0] >= true)


def test_of_a_smooth_curve_they_fall_at_least_with_the_square_of_the_spacing():
    coarse, fine = (errors_by_halves(knots(n), smooth(knots(n)), 1).curves[SOME, 0] for n in (32, 64))
    assert np.all(coarse / fine > [4.0, 3.0, 4.0])  # a peak stands anywhere between two positions


def test_a_peak_between_two_positions_counts():
    position = knots(32)
    peaked = np.maximum(0.0, 1.0 - np.abs(position - (8.5 / 32)) * 8.0)[:, None]
    missed = 1.0 - peaked.max()
    assert missed > 0.1
    assert errors_by_halves(position, peaked, 1).curves[PEAK_TO_PEAK, 0] >= missed
    position = knots(64)
    band = errors_by_halves(position, smooth(position), 1).band[:, 0]
    middle = smooth(position + 0.5 / 64)[:, 0]
    ahead = 0.5 * (smooth(position) + smooth(position + 1.0 / 64))[:, 0]
    assert np.mean(band > 0.0) > 0.9 and band.max() < np.abs(middle - ahead).max()


def test_errors_scale_with_the_curve_and_ignore_level_and_pitches():
    position, values = knots(32), kinked(knots(32))
    plain = errors_by_halves(position, values, 1)
    moved = errors_by_halves(position, 3.0 * values + 7.0, 1)
    assert moved.curves[1:] == pytest.approx(3.0 * plain.curves[1:], rel=1e-9, abs=1e-14)
    assert moved.band == pytest.approx(3.0 * plain.band, rel=1e-9, abs=1e-14)
    one, three = (errors_by_halves(knots(32, n), kinked(knots(32, n)), n) for n in (1, 3))
    assert three.curves[SOME] == pytest.approx(one.curves[SOME], rel=1e-6, abs=1e-12)
    assert three.band[:32] == pytest.approx(one.band, rel=1e-9, abs=1e-14)


def trapezoid_wave(position: np.ndarray) -> np.ndarray:
    """Near-square waves with kinks at places no grid knows, one per load level."""
    kinks = np.array([0.2137, 0.2071])
    phase = np.abs((position[:, None] + 0.5) % 1.0 - 0.5)
    return np.array([1e-6, 3e-6]) * (2.0 - np.clip((phase - kinks) / 0.03, 0.0, 1.0))


def repeating(wave):
    """Return the wave as curves of one base pitch that repeats."""
    return lambda position: wave(position)[None]


def held_out(nodes: np.ndarray) -> np.ndarray:
    query = np.random.default_rng(1).random(2000)
    found = interpolate(Axis(nodes, 1.0), trapezoid_wave(nodes), query)
    return np.abs(found - trapezoid_wave(query)).max(axis=0)


def test_adaptive_nodes_gather_at_the_kinks_and_meet_their_tolerance():
    nodes = adaptive_nodes(NodeRule(32, 0.002, 768), repeating(trapezoid_wave))
    assert np.all(nodes.error <= 0.002 * np.array([1e-6, 3e-6]))
    # the middles of the intervals are not the worst places, so some slack over the stated error
    assert np.all(held_out(nodes.position) <= 2.0 * 0.002 * np.array([1e-6, 3e-6]))
    nodes = adaptive_nodes(NodeRule(32, 0.002, 768), repeating(trapezoid_wave)).position
    spacing = np.diff(nodes, append=nodes[0] + 1.0)
    near = np.abs((nodes + 0.5) % 1.0 - 0.5)
    assert spacing[(near > 0.2) & (near < 0.25)].min() < spacing[near < 0.15].min() / 8.0
    nodes = adaptive_nodes(NodeRule(16, 0.002, 768), lambda x: np.ones((1, x.size, 1)))
    assert nodes.position.size == 16
    assert nodes.error == pytest.approx(0.0, abs=1e-12)


def test_a_jump_ends_at_the_node_limit_with_a_finite_error():
    def jump(position):
        return np.where(position < 0.3, 0.0, 1.0)[:, None] + 0.01 * np.sin(2 * np.pi * position)[:, None]

    nodes = adaptive_nodes(NodeRule(16, 1e-9, 768), repeating(jump))
    assert nodes.position.size <= 768
    assert np.all(np.isfinite(nodes.error))
    assert nodes.error.max() > 0.1
