"""Interpolation along one axis and of levels over several: exact at knots, C1, no overshoot, order kept."""

import numpy as np
import pytest

from fe_contact.ste import level_grid
from fe_contact.ste.interpolation import Axis, interpolate, monotone_slopes, ordered_slopes
from fe_contact.ste.level_grid import deflection_grid, monotone_stiffness, stiffness_grid

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


@pytest.mark.parametrize("values", [SQUARE, RNG.normal(size=23), UNEVEN**3])
def test_no_value_leaves_its_interval(values):
    axis = Axis(UNEVEN, 1.0)
    at = axis.stencil(FINE)
    curve = interpolate(axis, values, FINE)
    low = np.minimum(values[at.left], values[at.right])
    high = np.maximum(values[at.left], values[at.right])
    assert np.all(curve >= low - 1e-15 * np.abs(low))
    assert np.all(curve <= high + 1e-15 * np.abs(high))


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


def test_open_axes_reproduce_lines_and_hold_their_end_values():
    axis = Axis(UNEVEN)
    query = np.linspace(UNEVEN[0], UNEVEN[-1], 301)
    assert np.allclose(interpolate(axis, 2.0 - 3.0 * UNEVEN, query), 2.0 - 3.0 * query, rtol=0, atol=1e-14)
    axis = Axis(np.array([1.0, 2.0, 4.0]))
    assert interpolate(axis, np.array([5.0, 6.0, 9.0]), np.array([-7.0, 40.0])).tolist() == [5.0, 9.0]


def test_steps_and_corners_stay_between_their_knots():
    """Between flat knots the curve is flat: the step does not leak into its neighbors."""
    knots = np.arange(20) / 20
    values = np.where(knots < 0.5, 1.0, 0.0)
    quiet = np.linspace(0.05, 0.45, 101)
    assert np.all(np.abs(interpolate(Axis(knots, 1.0), values, quiet) - 1.0) <= 4 * EPSILON)
    # Akima's slopes: two straight flanks are exact up to the interval that hides their corner.
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
def test_a_family_keeps_its_order_and_does_not_overshoot(seed):
    axis, levels = family(seed)
    curves = with_slopes(axis, levels, ordered_slopes(axis, levels))
    assert np.all(np.diff(curves, axis=1) > 0.0)
    at = axis.stencil(FINE)
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


SEEDS = range(8)


def axes(rng):
    """Position (periodic), misalignment, center distance."""
    return (
        Axis(np.sort(rng.uniform(0, 1, 7)), 1.0),
        Axis(np.cumsum(rng.uniform(0.1, 1.0, 4))),
        Axis(np.cumsum(rng.uniform(0.1, 1.0, 3))),
    )


def slopes(rule, grid, values):
    return tuple(np.moveaxis(rule(axis, np.moveaxis(values, i, 0)), 0, i) for i, axis in enumerate(grid))


def wild(seed):
    """Deflections whose gaps jump over four decades from knot to knot, and stiffnesses as wild."""
    rng = np.random.default_rng(seed)
    grid = axes(rng)
    shape = tuple(len(axis.knots) for axis in grid)
    levels = np.cumsum(10.0 ** rng.uniform(-4.0, 0.0, (*shape, 4)), axis=-1)
    stiffness = 10.0 ** rng.uniform(-2.0, 3.0, (*shape, 4))
    stiffness[..., 0] = 0.0
    deflections = deflection_grid(grid, levels, slopes(ordered_slopes, grid, levels))
    return deflections, stiffness_grid(grid, stiffness, slopes(monotone_slopes, grid, stiffness)), rng


def sampled(grid, rng, count=4000):
    """All levels at random points."""
    at = tuple(axis.stencil(rng.uniform(axis.knots[0], axis.knots[-1], count)) for axis in grid.axes)
    columns = np.broadcast_to(np.arange(4), (count, 4))
    return at, grid.value(at, columns), columns


@pytest.mark.parametrize("seed", SEEDS)
def test_order_sign_and_bounds_hold_over_three_axes(seed):
    deflections, _, rng = wild(seed)
    assert np.all(np.diff(deflections.control_net(), axis=-1) > 0.0)
    assert np.all(np.diff(sampled(deflections, rng)[1], axis=1) > 0.0)
    _, stiffnesses, rng = wild(seed)
    assert np.all(stiffnesses.control_net()[..., 1:] >= 0.0)
    assert np.all(sampled(stiffnesses, rng)[1][:, 1:] > 0.0)
    # Bernstein coefficients enclose; the corners of a cell are values themselves.
    deflections, _, rng = wild(seed)
    net, values = deflections.control_net(), sampled(deflections, rng)[1]
    assert values.max() <= net.max() * (1.0 + 1e-12)
    assert values.min() >= net.min() * (1.0 - 1e-12)
    assert np.array_equal(net[0, 0, 0][:, :3, :2], deflections.nodal[(0, 0, 0)][:, :3, :2])
    # Stiffness times gap is at most three times the force step, on both sides of every level.
    deflections, stiffnesses, rng = wild(seed)
    level = np.array([0.0, 1.0, 5.0, 6.0])
    limited = monotone_stiffness(stiffnesses, deflections, level)
    at, d, columns = sampled(deflections, rng)
    k, gaps = limited.value(at, columns), np.diff(d, axis=1)
    assert np.all(k[:, :-1] * gaps <= 3.0 * np.diff(level))
    assert np.all(k[:, 1:] * gaps <= 3.0 * np.diff(level))
    assert np.any(stiffnesses.value(at, columns)[:, 1:] * gaps > 3.0 * np.diff(level))


def test_mixed_derivatives_of_zero_would_lose_the_order():
    """What the multiplicative ones are for."""
    lost = 0
    for seed in SEEDS:
        deflections, _, _ = wild(seed)
        for order, entry in deflections.nodal.items():
            if sum(order) > 1:
                entry[...] = 0.0
        lost += np.any(np.diff(deflections.control_net(), axis=-1) <= 0.0)
    assert lost == len(SEEDS)


def test_what_is_within_the_bound_is_not_touched():
    rng = np.random.default_rng(1)
    grid = axes(rng)
    shape = tuple(len(axis.knots) for axis in grid)
    levels = np.broadcast_to(np.arange(4.0), (*shape, 4)) + 0.2 * rng.uniform(size=(*shape, 1))
    stiffness = rng.uniform(0.8, 1.5, (*shape, 4))
    deflections = deflection_grid(grid, levels, slopes(ordered_slopes, grid, levels))
    stiffnesses = stiffness_grid(grid, stiffness, slopes(monotone_slopes, grid, stiffness))
    limited = monotone_stiffness(stiffnesses, deflections, np.arange(4.0))
    assert all(np.array_equal(limited.nodal[order], stiffnesses.nodal[order]) for order in stiffnesses.nodal)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_slope_is_that_of_the_value(seed):
    deflections, _, rng = wild(seed)
    x = rng.uniform(0.0, 1.0, 500)
    rest = tuple(
        axis.stencil(rng.uniform(axis.knots[0], axis.knots[-1], 500)) for axis in deflections.axes[1:]
    )
    columns = np.broadcast_to(np.arange(4), (500, 4))

    def value(moved):
        return deflections.value((deflections.axes[0].stencil(x + moved), *rest), columns)

    slope = deflections.slope((deflections.axes[0].stencil(x), *rest), columns)
    assert np.abs((value(1e-7) - value(-1e-7)) / 2e-7 - slope).max() < 1e-3 * np.abs(slope).max()


def test_the_bound_by_largest_factors_spares_work_and_changes_no_bit(monkeypatch):
    """Cells that it passes are those whose share would be 1."""
    formed = []

    def counting(net, gaps, dims):
        formed.append(net[(0,) * dims].size)
        return largest(net, gaps, dims)

    largest = level_grid._largest_product
    monkeypatch.setattr(level_grid, "_largest_product", counting)
    for seed in SEEDS:
        deflections, stiffnesses, rng = wild(seed)
        net, gaps = stiffnesses.control_net()[..., 1:], np.diff(deflections.control_net(), axis=-1)
        product = largest(net, gaps, 3)
        room = 10.0 ** rng.uniform(-1.0, 1.0, product.shape[-1]) * np.median(product)
        every = np.minimum((1.0 - 1e-12) * room / np.maximum(product, 1e-300), 1.0)
        assert np.array_equal(level_grid._share_allowed(net, gaps, room, 3), every)
        assert 0 < formed[-1] < product.size
        assert 0 < np.count_nonzero(every < 1.0) <= formed[-1]
