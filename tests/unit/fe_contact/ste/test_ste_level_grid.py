"""Levels over several axes: signs and order between the knots, and the bound on the stiffness."""

from __future__ import annotations

import numpy as np
import pytest

from fe_contact.ste import force_table as level_grid
from fe_contact.ste.force_table import deflection_grid, monotone_stiffness, stiffness_grid
from fe_contact.ste.interpolation import Axis, monotone_slopes, ordered_slopes

SEEDS = range(8)


def axes(rng):
    """Position (periodic), misalignment, center distance."""
    return (
        Axis(np.sort(rng.uniform(0, 1, 7)), 1.0),
        Axis(np.cumsum(rng.uniform(0.1, 1.0, 4))),
        Axis(np.cumsum(rng.uniform(0.1, 1.0, 3))),
    )


def slopes(rule, grid, values):
    """Slopes by one rule along every axis."""
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
def test_levels_stay_in_order_in_three_axes(seed):
    deflections, _, rng = wild(seed)
    assert np.all(np.diff(deflections.control_net(), axis=-1) > 0.0)
    assert np.all(np.diff(sampled(deflections, rng)[1], axis=1) > 0.0)


@pytest.mark.parametrize("seed", SEEDS)
def test_stiffness_stays_positive_in_three_axes(seed):
    _, stiffnesses, rng = wild(seed)
    assert np.all(stiffnesses.control_net()[..., 1:] >= 0.0)
    assert np.all(sampled(stiffnesses, rng)[1][:, 1:] > 0.0)


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


@pytest.mark.parametrize("seed", SEEDS)
def test_the_control_net_bounds_the_interpolant(seed):
    """Bernstein coefficients enclose; the corners of a cell are values themselves."""
    deflections, _, rng = wild(seed)
    net, values = deflections.control_net(), sampled(deflections, rng)[1]
    assert values.max() <= net.max() * (1.0 + 1e-12)
    assert values.min() >= net.min() * (1.0 - 1e-12)
    assert np.array_equal(net[0, 0, 0][:, :3, :2], deflections.nodal[(0, 0, 0)][:, :3, :2])


@pytest.mark.parametrize("seed", SEEDS)
def test_the_bound_holds_between_the_knots(seed):
    """Stiffness times gap is at most three times the force step, on both sides of every level."""
    deflections, stiffnesses, rng = wild(seed)
    level = np.array([0.0, 1.0, 5.0, 6.0])
    limited = monotone_stiffness(stiffnesses, deflections, level)
    at, d, columns = sampled(deflections, rng)
    k, gaps = limited.value(at, columns), np.diff(d, axis=1)
    assert np.all(k[:, :-1] * gaps <= 3.0 * np.diff(level))
    assert np.all(k[:, 1:] * gaps <= 3.0 * np.diff(level))
    assert np.any(stiffnesses.value(at, columns)[:, 1:] * gaps > 3.0 * np.diff(level))


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
