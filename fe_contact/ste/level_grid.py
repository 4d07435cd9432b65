"""Tensor-product cubic Hermite interpolation of a stack of levels over several coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import comb, prod

import numpy as np

from fe_contact.ste.interpolation import Axis, Stencil
from fe_contact.types import FloatArray, IntArray

Order = tuple[int, ...]  # differentiated once (1) or not (0), per axis


@dataclass(frozen=True)
class LevelGrid:
    """Numbers at the knots, (knots of each axis ..., anything ...), by order of differentiation."""

    axes: tuple[Axis, ...]
    nodal: dict[Order, FloatArray]

    def value(self, at: tuple[Stencil, ...], columns: IntArray) -> FloatArray:
        """Value of the given levels (Q, C) of each query."""
        return self._sum(at, columns, [stencil.weights for stencil in at])

    def slope(self, at: tuple[Stencil, ...], columns: IntArray) -> FloatArray:
        """Differentiate `value` in axis 0; zero if that has one knot only."""
        if len(self.axes[0].knots) == 1:
            return np.zeros(columns.shape)
        return self._sum(at, columns, [at[0].weight_slopes, *(stencil.weights for stencil in at[1:])])

    def _sum(self, at: tuple[Stencil, ...], columns: IntArray, weights: list[FloatArray]) -> FloatArray:
        """Sum of weight times nodal number over the corners of each query's cell."""
        sides = product(*((0, 1) if len(axis.knots) > 1 else (0,) for axis in self.axes))
        total: FloatArray | float = 0.0
        for corner in sides:
            indices = ((stencil.left, stencil.right)[side] for stencil, side in zip(at, corner, strict=True))
            node = (*(index[:, None] for index in indices), columns)
            for order, entry in self.nodal.items():
                total = total + self._factor(weights, corner, order) * entry[node]
        return np.asarray(total)

    def _factor(self, weights: list[FloatArray], corner: Order, order: Order) -> FloatArray:
        """Product of the one-axis weights of a corner and an order, (Q, 1); axes of one knot are left out."""
        chosen = zip(self.axes, weights, corner, order, strict=True)
        factors = [weight[side, once] for axis, weight, side, once in chosen if len(axis.knots) > 1]
        return np.asarray(prod(factors[1:], start=factors[0])[:, None] if factors else np.ones((1, 1)))

    def control_net(self) -> FloatArray:
        """Bernstein coefficients of every cell, which bound the interpolant in it.

        Shape: 4 per axis (1 for an axis of one knot), last axis first; then the cells; then what follows.
        """
        nets = self.nodal
        for i, axis in enumerate(self.axes):
            tails = {order[1:] for order in nets}
            nets = {tail: _bernstein(axis, 2 * i, nets[(0, *tail)], nets.get((1, *tail))) for tail in tails}
        return nets[()]

    def scaled(self, factor: FloatArray) -> LevelGrid:
        """Return the grid with everything at a knot multiplied by that knot's factor."""
        return LevelGrid(self.axes, {order: entry * factor for order, entry in self.nodal.items()})


def deflection_grid(axes: tuple[Axis, ...], levels: FloatArray, slopes: tuple[FloatArray, ...]) -> LevelGrid:
    """Grid of increasing levels (..., L); the gaps between levels are what stays positive."""
    gaps = np.diff(levels, axis=-1)
    nodal = {}
    for order in _orders(axes):
        mixed = [np.diff(slope, axis=-1) for slope, once in zip(slopes, order, strict=True) if once]
        if len(mixed) < 2:
            nodal[order] = _plain(order, levels, slopes)
        else:
            twist = np.cumsum(prod(mixed[1:], start=mixed[0]) / gaps ** (len(mixed) - 1), axis=-1)
            nodal[order] = np.concatenate([np.zeros_like(twist[..., :1]), twist], axis=-1)
    return LevelGrid(axes, nodal)


def stiffness_grid(
    axes: tuple[Axis, ...], stiffness: FloatArray, slopes: tuple[FloatArray, ...]
) -> LevelGrid:
    """Grid of stiffnesses >= 0; they stay >= 0."""
    nodal = {}
    divisor = np.where(stiffness > 0.0, stiffness, 1.0)
    for order in _orders(axes):
        mixed = [slope for slope, once in zip(slopes, order, strict=True) if once]
        if len(mixed) < 2:
            nodal[order] = _plain(order, stiffness, slopes)
        else:
            nodal[order] = prod(mixed[1:], start=mixed[0]) / divisor ** (len(mixed) - 1)
    return LevelGrid(axes, nodal)


def monotone_stiffness(stiffness: LevelGrid, deflection: LevelGrid, level: FloatArray) -> LevelGrid:
    """Stiffness cut where the force could otherwise fall with deflection, anywhere between the knots.

    A cubic from (d_k, F_k, K_k) to (d_k+1, F_k+1, K_k+1) is monotone if both K are at most three times the
    secant (de Boor and Swartz), that is K (d_k+1 - d_k) <= 3 (F_k+1 - F_k). Both factors are polynomials in
    a cell, so the Bernstein coefficients of their product bound it. Scaling all numbers at a knot scales
    its share of these coefficients, so one pass is enough; where nothing is violated nothing changes.
    """
    dims = len(stiffness.axes)
    net, gaps = stiffness.control_net(), np.diff(deflection.control_net(), axis=-1)
    room = 3.0 * np.diff(level)
    below = _knot_minimum(stiffness.axes, _share_allowed(net[..., :-1], gaps, room, dims))
    above = _knot_minimum(stiffness.axes, _share_allowed(net[..., 1:], gaps, room, dims))
    free = np.ones_like(below[..., :1])
    return stiffness.scaled(np.minimum(np.concatenate([below, free], -1), np.concatenate([free, above], -1)))


def _share_allowed(net: FloatArray, gaps: FloatArray, room: FloatArray, dims: int) -> FloatArray:
    """Share (cells ..., L - 1), at most 1, of the stiffness whose product with the gaps keeps to `room`.

    Coefficients of a product are means of products of the factors', so that those of a cell need not be
    formed where the largest of both factors keep to the room.
    """
    over = tuple(range(dims))
    largest = (np.maximum(factor.max(axis=over), -factor.min(axis=over)) for factor in (net, gaps))
    crowded = prod(largest) > (1.0 - 2e-12) * room
    room = np.broadcast_to(room, crowded.shape)[crowded]
    product = _largest_product(net[..., crowded], gaps[..., crowded], dims)
    share = np.ones(crowded.shape)
    # a cell's coefficients mix its knots' numbers; rounding of the bound itself is given away here
    share[crowded] = np.minimum((1.0 - 1e-12) * room / np.maximum(product, 1e-300), 1.0)
    return share


def _orders(axes: tuple[Axis, ...]) -> list[Order]:
    """Subsets of the axes to differentiate in; an axis of one knot has no derivative."""
    return list(product(*((0, 1) if len(axis.knots) > 1 else (0,) for axis in axes)))


def _plain(order: Order, values: FloatArray, slopes: tuple[FloatArray, ...]) -> FloatArray:
    return slopes[order.index(1)] if any(order) else values


def _bernstein(axis: Axis, along: int, value: FloatArray, slope: FloatArray | None) -> FloatArray:
    """Four Bernstein coefficients of every interval along one array axis, stacked in front."""
    if slope is None:
        return value[None]
    value, slope = np.moveaxis(value, along, 0), np.moveaxis(slope, along, 0)
    third = axis.spacing.reshape(-1, *(1,) * (value.ndim - 1)) / 3.0
    cells = len(axis.spacing)
    right, right_slope = np.roll(value, -1, axis=0)[:cells], np.roll(slope, -1, axis=0)[:cells]
    left, left_slope = value[:cells], slope[:cells]
    net = np.array([left, left + third * left_slope, right - third * right_slope, right])
    return np.moveaxis(net, 1, along + 1)


def _largest_product(first: FloatArray, second: FloatArray, dims: int) -> FloatArray:
    """Largest Bernstein coefficient, per cell, of the product of two control nets."""
    sums: dict[Order, FloatArray | float] = {}
    indices = list(product(*(range(size) for size in first.shape[:dims])))
    for p, q in product(indices, indices):
        share = prod(_product_weight(size, i, j) for size, i, j in zip(first.shape, p, q, strict=False))
        total = tuple(i + j for i, j in zip(p, q, strict=True))
        sums[total] = sums.get(total, 0.0) + share * first[p] * second[q]
    return np.asarray(np.max(np.array(list(sums.values())), axis=0))


def _product_weight(size: int, i: int, j: int) -> float:
    degree = size - 1
    return comb(degree, i) * comb(degree, j) / comb(2 * degree, i + j)


def _knot_minimum(axes: tuple[Axis, ...], per_cell: FloatArray) -> FloatArray:
    """Smallest value among the cells that share a knot."""
    for i, axis in enumerate(axes):
        if len(axis.knots) > 1:
            cells = np.moveaxis(per_cell, i, 0)
            before, after = axis.neighbors(cells, np.inf)
            per_cell = np.moveaxis(np.minimum(before, after), 0, i)
    return per_cell
