"""Laws of the position interpolation: exact at knots, periodic, C1, no overshoot, order kept."""

from __future__ import annotations

import numpy as np
import pytest

from fe_contact.ste.interpolation import Axis, interpolate, monotone_slopes, ordered_slopes

FINE = np.linspace(-0.5, 1.5, 4001)
EPSILON = np.finfo(float).eps
RNG = np.random.default_rng(7)
UNEVEN = np.sort(RNG.uniform(0.0, 1.0, 23))
SQUARE = np.where((UNEVEN > 0.2) & (UNEVEN < 0.6), 7.8, 5.1)


def derivative(axis, values, at):
    """Derivative of the interpolant, from its own weights."""
    stencil, slopes = axis.stencil(at), monotone_slopes(axis, values)
    weights = stencil.weight_slopes
    left = weights[0, 0] * values[stencil.left] + weights[0, 1] * slopes[stencil.left]
    return left + weights[1, 0] * values[stencil.right] + weights[1, 1] * slopes[stencil.right]


@pytest.mark.parametrize("values", [SQUARE, RNG.normal(size=23), np.full(23, 3.0), UNEVEN**3])
def test_knots_are_returned_exactly(values):
    axis = Axis(UNEVEN, 1.0)
    assert np.array_equal(interpolate(axis, values, UNEVEN), values)


@pytest.mark.parametrize("values", [SQUARE, RNG.normal(size=23), UNEVEN**3])
def test_no_value_leaves_its_interval(values):
    axis = Axis(UNEVEN, 1.0)
    at = axis.stencil(FINE)
    curve = interpolate(axis, values, FINE)
    low = np.minimum(values[at.left], values[at.right])
    high = np.maximum(values[at.left], values[at.right])
    assert np.all(curve >= low - 1e-15 * np.abs(low))
    assert np.all(curve <= high + 1e-15 * np.abs(high))


def test_square_wave_keeps_flat_tops():
    curve = interpolate(Axis(UNEVEN, 1.0), SQUARE, FINE)
    assert curve.max() <= 7.8 * (1.0 + 4 * EPSILON)
    assert curve.min() >= 5.1 * (1.0 - 4 * EPSILON)


def test_period_is_one():
    axis, values = Axis(UNEVEN, 1.0), RNG.normal(size=23)
    query = RNG.uniform(0.0, 1.0, 200)
    for turns in (-3, 1, 1000):
        assert np.allclose(
            interpolate(axis, values, query + turns), interpolate(axis, values, query), atol=1e-9
        )


@pytest.mark.parametrize("at", [UNEVEN, UNEVEN[:1] + 1.0, UNEVEN[-1:]])
def test_slope_is_continuous_at_every_knot_and_across_the_seam(at):
    axis, values = Axis(UNEVEN, 1.0), RNG.normal(size=23)
    before, after = derivative(axis, values, at - 1e-9), derivative(axis, values, at + 1e-9)
    spread = np.abs(derivative(axis, values, FINE)).max()
    assert np.all(np.abs(after - before) <= 1e-5 * spread)


def test_derivative_weights_are_the_derivative_of_the_weights():
    stencil = Axis(UNEVEN, 1.0).stencil(np.linspace(0.1, 0.9, 57))
    step = 1e-6
    shifted = [type(stencil)(*moved(stencil, s)).weights for s in (-step, step)]
    assert np.allclose((shifted[1] - shifted[0]) / (2 * step), stencil.weight_slopes, rtol=1e-5, atol=1e-4)


def moved(stencil, by):
    """The same cells with all queries moved."""
    fraction = stencil.fraction + by / stencil.width
    return stencil.left, stencil.right, stencil.width, fraction, stencil.outside


def test_error_falls_with_the_second_power_of_the_spacing():
    """Extrema between knots are cut off flat, so the order of a smooth curve is two, not four."""
    for count in (16, 32, 64, 128, 256):
        knots = np.arange(count) / count
        worst = 0.0
        for phase in np.linspace(0.0, 2 * np.pi / count, 11):  # of the extremum between its knots
            curve = interpolate(Axis(knots, 1.0), np.sin(2 * np.pi * knots + phase), FINE)
            worst = max(worst, np.abs(curve - np.sin(2 * np.pi * FINE + phase)).max())
        cut = (np.pi / count) ** 2 / 2  # the sine between its top and half a spacing beside it
        assert worst == pytest.approx(cut, rel=0.02)


def test_straight_lines_are_reproduced_on_open_axes():
    axis = Axis(UNEVEN)
    query = np.linspace(UNEVEN[0], UNEVEN[-1], 301)
    assert np.allclose(interpolate(axis, 2.0 - 3.0 * UNEVEN, query), 2.0 - 3.0 * query, rtol=0, atol=1e-14)


def test_open_axes_hold_their_end_values():
    axis = Axis(np.array([1.0, 2.0, 4.0]))
    assert interpolate(axis, np.array([5.0, 6.0, 9.0]), np.array([-7.0, 40.0])).tolist() == [5.0, 9.0]


@pytest.mark.parametrize("period", [0.0, 1.0])
@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_knots(count, period):
    knots, values = np.array([0.1, 0.3, 0.8])[:count], np.array([1.0, 4.0, 2.0])[:count]
    curve = interpolate(Axis(knots, period), values, FINE)
    assert curve.min() >= values.min() - 1e-15
    assert curve.max() <= values.max() + 1e-15


def test_square_wave_steps_are_as_sharp_as_their_knots():
    """Between flat knots the curve is flat: the step does not leak into its neighbors."""
    knots = np.arange(20) / 20
    values = np.where(knots < 0.5, 1.0, 0.0)
    quiet = np.linspace(0.05, 0.45, 101)
    assert np.all(np.abs(interpolate(Axis(knots, 1.0), values, quiet) - 1.0) <= 4 * EPSILON)


def test_a_corner_between_knots_stays_between_them():
    """Akima's slopes: two straight flanks are exact up to the interval that hides their corner."""
    knots = np.array([0.0, 0.1, 0.2, 0.3, 0.45, 0.6, 0.7, 0.85, 1.0])
    corner = np.maximum(knots - 0.37, 0.0) + 0.2 * knots
    query = np.linspace(0.0, 1.0, 401)
    error = np.abs(interpolate(Axis(knots), corner, query) - np.maximum(query - 0.37, 0.0) - 0.2 * query)
    hidden = (query > 0.3) & (query < 0.45)
    assert error[~hidden].max() < 1e-14
    assert error[hidden].max() > 1e-3


def family(seed, count=17, curves=6):
    """Increasing levels with jumps in different places, some almost touching."""
    rng = np.random.default_rng(seed)
    steps = 10.0 ** rng.uniform(-6.0, 0.0, (count, curves))
    return Axis(np.sort(rng.uniform(0, 1, count)), 1.0), np.cumsum(steps, axis=1) + rng.normal(
        size=(count, 1)
    )


@pytest.mark.parametrize("seed", range(20))
def test_a_family_keeps_its_order_between_knots(seed):
    axis, levels = family(seed)
    curves = with_slopes(axis, levels, ordered_slopes(axis, levels))
    assert np.all(np.diff(curves, axis=1) > 0.0)


@pytest.mark.parametrize("seed", range(20))
def test_a_family_does_not_overshoot(seed):
    axis, levels = family(seed)
    at = axis.stencil(FINE)
    curves = with_slopes(axis, levels, ordered_slopes(axis, levels))
    assert np.all(curves >= np.minimum(levels[at.left], levels[at.right]) - 1e-14)
    assert np.all(curves <= np.maximum(levels[at.left], levels[at.right]) + 1e-14)


def test_independent_slopes_would_break_the_order():
    """What `ordered_slopes` is for: with single-curve slopes the same families cross."""
    crossings = 0
    for seed in range(20):
        axis, levels = family(seed)
        crossings += np.any(np.diff(with_slopes(axis, levels, monotone_slopes(axis, levels)), axis=1) <= 0.0)
    assert crossings > 5


def test_ordering_changes_nothing_where_nothing_threatens_it():
    axis = Axis(np.arange(32) / 32, 1.0)
    wave = np.sin(2 * np.pi * axis.knots)[:, None]
    levels = wave * [0.9, 1.0, 1.1] + [0.0, 5.0, 10.0]
    assert np.array_equal(ordered_slopes(axis, levels), monotone_slopes(axis, levels))


def with_slopes(axis, levels, slopes):
    """Evaluate given slopes on the fine grid."""
    at = axis.stencil(FINE)
    weights = at.weights[..., None]
    left = weights[0, 0] * levels[at.left] + weights[0, 1] * slopes[at.left]
    return left + weights[1, 0] * levels[at.right] + weights[1, 1] * slopes[at.right]
