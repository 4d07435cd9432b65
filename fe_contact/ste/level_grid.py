"""Tensor-product cubic Hermite interpolation of a stack of levels over several coordinates.

A level is the curve of a quantity at one load; L levels stand on the last array axis. A coordinate axis has
knots, and a cell is the box between neighboring knots of all axes. An axis may have a single knot: nothing
depends on its coordinate. Q queries are points at which the interpolant is evaluated.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import comb, prod

import numpy as np

from fe_contact.ste.interpolation import Axis, Stencil
from fe_contact.types import FloatArray, IntArray

Order = tuple[int, ...]
"""Order of differentiation for each axis: 1 differentiated once, 0 not."""

ROUNDING = 1e-12
"""Relative rounding error of Bernstein coefficients that the limit of stiffness leaves room for."""


@dataclass(frozen=True)
class LevelGrid:
    """Values and derivatives at the knots, from which the interpolant is built."""

    axes: tuple[Axis, ...]
    nodal: dict[Order, FloatArray]
    """Derivatives at the knots by order; that of zeros has the values. Shape: knots of each axis, then L."""

    def value(self, at: tuple[Stencil, ...], columns: IntArray) -> FloatArray:
        """Return the values (Q, C) at the queries, of the levels with the indices `columns` (Q, C)."""
        return self._sum(at, columns, [stencil.weights for stencil in at])

    def slope(self, at: tuple[Stencil, ...], columns: IntArray) -> FloatArray:
        """Return the derivatives of `value` by the coordinate of axis 0; zero if that has one knot only."""
        if len(self.axes[0].knots) == 1:
            return np.zeros(columns.shape)
        return self._sum(at, columns, [at[0].weight_slopes, *(stencil.weights for stencil in at[1:])])

    def _sum(self, at: tuple[Stencil, ...], columns: IntArray, weights: list[FloatArray]) -> FloatArray:
        """Return the sum of weight times nodal number over the corners of each query's cell."""
        total: FloatArray | float = 0.0
        for corner in _orders(self.axes):  # 0 and 1: left and right knot
            indices = (
                stencil.right if side else stencil.left for stencil, side in zip(at, corner, strict=True)
            )
            node = (*(index[:, None] for index in indices), columns)
            for order, entry in self.nodal.items():
                total = total + self._factor(weights, corner, order) * entry[node]
        return np.asarray(total)

    def _factor(self, weights: list[FloatArray], corner: Order, order: Order) -> FloatArray:
        """Return the product of the weights of a corner and an order, (Q, 1), without axes of one knot."""
        by_axis = zip(self.axes, weights, corner, order, strict=True)
        factors = [weight[side, slope] for axis, weight, side, slope in by_axis if len(axis.knots) > 1]
        return np.asarray(prod(factors[1:], start=factors[0])[:, None] if factors else np.ones((1, 1)))

    def control_net(self) -> FloatArray:
        """Return the Bernstein coefficients of every cell, which bound the interpolant in it.

        Shape: 4 per axis (1 for an axis of one knot), last axis first; then the cells of each axis; then L.
        """
        nets = self.nodal
        # each pass turns the leading entry of the orders, that of axis i, into Bernstein coefficients
        for i, axis in enumerate(self.axes):
            tails = {order[1:] for order in nets}
            nets = {tail: _bernstein(axis, 2 * i, nets[(0, *tail)], nets.get((1, *tail))) for tail in tails}
        return nets[()]

    def scaled(self, factor: FloatArray) -> LevelGrid:
        """Return the grid with values and derivatives multiplied by the `factor` of their knot and level."""
        return LevelGrid(self.axes, {order: entry * factor for order, entry in self.nodal.items()})


def deflection_grid(axes: tuple[Axis, ...], levels: FloatArray, slopes: tuple[FloatArray, ...]) -> LevelGrid:
    """Return the grid of increasing levels (..., L); interpolated levels stay increasing.

    `slopes` are the derivatives of the levels by each axis. Mixed derivatives are those of gaps between
    levels that are products of functions of one coordinate: gap_xy = gap_x gap_y / gap.
    """
    gaps = np.diff(levels, axis=-1)
    nodal = {}
    for order in _orders(axes):
        mixed = [np.diff(slope, axis=-1) for slope, degree in zip(slopes, order, strict=True) if degree]
        if len(mixed) < 2:
            nodal[order] = _value_or_slope(order, levels, slopes)
        else:
            twist = np.cumsum(prod(mixed[1:], start=mixed[0]) / gaps ** (len(mixed) - 1), axis=-1)
            nodal[order] = np.concatenate([np.zeros_like(twist[..., :1]), twist], axis=-1)
    return LevelGrid(axes, nodal)


def stiffness_grid(
    axes: tuple[Axis, ...], stiffness: FloatArray, slopes: tuple[FloatArray, ...]
) -> LevelGrid:
    """Return the grid of stiffnesses >= 0; interpolated stiffnesses stay >= 0.

    Mixed derivatives are those of a product of functions of one coordinate, as in `deflection_grid`.
    """
    nodal = {}
    divisor = np.where(stiffness > 0.0, stiffness, 1.0)  # where a stiffness is 0, so are its slopes
    for order in _orders(axes):
        mixed = [slope for slope, degree in zip(slopes, order, strict=True) if degree]
        if len(mixed) < 2:
            nodal[order] = _value_or_slope(order, stiffness, slopes)
        else:
            nodal[order] = prod(mixed[1:], start=mixed[0]) / divisor ** (len(mixed) - 1)
    return LevelGrid(axes, nodal)


def monotone_stiffness(stiffness: LevelGrid, deflection: LevelGrid, level: FloatArray) -> LevelGrid:
    """Return the stiffness, reduced where the force could fall with deflection anywhere between the knots.

    A cubic from (d_k, F_k, K_k) to (d_k+1, F_k+1, K_k+1) is monotone if both K are at most three times the
    secant (de Boor and Swartz), that is K (d_k+1 - d_k) <= 3 (F_k+1 - F_k). Both factors are polynomials in
    a cell, so the Bernstein coefficients of their product bound it. Scaling all numbers at a knot scales
    its share of these coefficients, so one pass is enough; where nothing is violated nothing changes.
    """
    dims = len(stiffness.axes)
    net, gaps = stiffness.control_net(), np.diff(deflection.control_net(), axis=-1)
    limit = 3.0 * np.diff(level)
    below = _knot_minimum(stiffness.axes, _share_allowed(net[..., :-1], gaps, limit, dims))
    above = _knot_minimum(stiffness.axes, _share_allowed(net[..., 1:], gaps, limit, dims))
    free = np.ones_like(below[..., :1])  # no gap above the last level, none below the first
    factor = np.minimum(np.concatenate([below, free], axis=-1), np.concatenate([free, above], axis=-1))
    return stiffness.scaled(factor)


def _share_allowed(net: FloatArray, gaps: FloatArray, limit: FloatArray, dims: int) -> FloatArray:
    """Return the largest share (cells ..., L - 1) of the stiffness whose product with the gaps is in a limit.

    The share is at most 1; `limit` (L - 1,) is the largest product allowed. Coefficients of a product are
    means of products of the factors' coefficients. So a cell whose largest coefficients have a product within
    the limit has a share of 1, and the coefficients of its product are not formed.
    """
    coefficients = tuple(range(dims))  # array axes
    largest_stiffness = np.maximum(net.max(axis=coefficients), -net.min(axis=coefficients))
    largest_gap = np.maximum(gaps.max(axis=coefficients), -gaps.min(axis=coefficients))
    critical = largest_stiffness * largest_gap > (1.0 - 2.0 * ROUNDING) * limit
    limit = np.broadcast_to(limit, critical.shape)[critical]
    product = _largest_product(net[..., critical], gaps[..., critical], dims)
    share = np.ones(critical.shape)
    # a cell's coefficients mix its knots' numbers; a product of 0 has a share of 1
    share[critical] = np.minimum((1.0 - ROUNDING) * limit / np.maximum(product, 1e-300), 1.0)
    return share


def _orders(axes: tuple[Axis, ...]) -> list[Order]:
    """Return all orders of differentiation; an axis of one knot has no derivative."""
    return list(product(*((0, 1) if len(axis.knots) > 1 else (0,) for axis in axes)))


def _value_or_slope(order: Order, values: FloatArray, slopes: tuple[FloatArray, ...]) -> FloatArray:
    """Return the values for the order of zeros, else the slope by the one axis of the order."""
    return slopes[order.index(1)] if any(order) else values


def _bernstein(axis: Axis, along: int, value: FloatArray, slope: FloatArray | None) -> FloatArray:
    """Return the four Bernstein coefficients of every interval along one array axis, stacked in front.

    An axis of one knot, without `slope`, has one coefficient, the value.
    """
    if slope is None:
        return value[None]
    value, slope = np.moveaxis(value, along, 0), np.moveaxis(slope, along, 0)
    third = axis.spacing.reshape(-1, *(1,) * (value.ndim - 1)) / 3.0
    cells = len(axis.spacing)
    # the last interval of a periodic axis ends at the first knot: `roll` puts it there
    right, right_slope = np.roll(value, -1, axis=0)[:cells], np.roll(slope, -1, axis=0)[:cells]
    left, left_slope = value[:cells], slope[:cells]
    net = np.array([left, left + third * left_slope, right - third * right_slope, right])
    return np.moveaxis(net, 1, along + 1)


def _largest_product(first: FloatArray, second: FloatArray, dims: int) -> FloatArray:
    """Return the largest Bernstein coefficient, per cell, of the product of two control nets."""
    sums: dict[Order, FloatArray | float] = {}
    indices = list(product(*(range(size) for size in first.shape[:dims])))
    for p, q in product(indices, indices):
        # `p` has an index for each of the first `dims` array axes: `zip` leaves out the sizes of the others
        share = prod(_product_weight(size, i, j) for size, i, j in zip(first.shape, p, q, strict=False))
        total = tuple(i + j for i, j in zip(p, q, strict=True))
        sums[total] = sums.get(total, 0.0) + share * first[p] * second[q]
    return np.asarray(np.max(np.array(list(sums.values())), axis=0))


def _product_weight(size: int, i: int, j: int) -> float:
    """Return the weight of b_i c_j in coefficient i + j of the product of two Bernstein polynomials."""
    degree = size - 1
    return comb(degree, i) * comb(degree, j) / comb(2 * degree, i + j)


def _knot_minimum(axes: tuple[Axis, ...], per_cell: FloatArray) -> FloatArray:
    """Return the smallest value among the cells that share a knot, for each knot."""
    for i, axis in enumerate(axes):
        if len(axis.knots) > 1:
            cells = np.moveaxis(per_cell, i, 0)
            before, after = axis.neighbors(cells, np.inf)
            per_cell = np.moveaxis(np.minimum(before, after), 0, i)
    return per_cell
