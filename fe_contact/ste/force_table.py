"""Tables of forces over transmission errors: their levels, their cubics, their pieces."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from itertools import product
from math import comb, prod

import numpy as np
from numpy.typing import NDArray

from bounds.brief import brief
from fe_contact.ste.interpolation import Axis, Stencil
from fe_contact.types import FloatArray, IntArray

# Tensor-product cubic Hermite interpolation of a stack of levels over several coordinates.
#
# Every knot carries the value and, for each subset of the axes, the mixed derivative once in each of them.
# The interpolant is linear in these numbers, so it is C1 in all coordinates jointly. Mixed derivatives are
# chosen multiplicatively (f_xy = f_x f_y / f): the Bernstein coefficients of a positive quantity are then
# products of positive numbers, so it stays positive between the knots in any number of axes.

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


# The cubic of the force between two levels: value, derivatives, and the deflection for a given force.


@dataclass(frozen=True)
class ForceCubic:
    """One cubic per query, between two levels: deflection, force and stiffness at its ends, each (Q, 2)."""

    deflection_ends: FloatArray
    deflection_slopes: FloatArray
    force_ends: FloatArray
    stiffness_ends: FloatArray
    stiffness_slopes: FloatArray

    @cached_property
    def width(self) -> FloatArray:
        """Deflection from the lower to the upper end."""
        return np.asarray(self.deflection_ends[:, 1] - self.deflection_ends[:, 0])

    @cached_property
    def tangent_ends(self) -> FloatArray:
        """Derivatives of the force in the fraction of the width at both ends, (2, Q)."""
        return np.asarray(self.width * self.stiffness_ends.T)

    def cubic(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force and its derivative in t at fraction t of the width."""
        (low, high), (k0, k1) = self.force_ends.T, self.tangent_ends
        s = 1.0 - t
        force = low + (high - low) * t * t * (3.0 - 2.0 * t) + t * s * (s * k0 - t * k1)
        return force, 6.0 * t * s * (high - low) + s * (1.0 - 3.0 * t) * k0 + t * (3.0 * t - 2.0) * k1

    def position_slope(self, t: FloatArray, tangent: FloatArray) -> FloatArray:
        """Differentiate in position at constant deflection; `tangent` is the derivative in t."""
        s = 1.0 - t
        width, width_slope = self.width, self.deflection_slopes[:, 1] - self.deflection_slopes[:, 0]
        end_tangents = width_slope[:, None] * self.stiffness_ends + width[:, None] * self.stiffness_slopes
        slope = -(self.deflection_slopes[:, 0] + t * width_slope) / width
        return np.asarray(tangent * slope + t * s * (s * end_tangents[:, 0] - t * end_tangents[:, 1]))

    def sample(
        self, d: FloatArray, lifted: NDArray[np.bool_], above: NDArray[np.bool_]
    ) -> tuple[FloatArray, ...]:
        """Force, stiffness and position slope at deflection d; zero if lifted off, straight above."""
        beyond = d - self.deflection_ends[:, 1]
        t = np.clip((d - self.deflection_ends[:, 0]) / self.width, 0.0, 1.0)
        force, tangent = self.cubic(t)
        end, end_slope = self.stiffness_ends[:, 1], self.stiffness_slopes[:, 1]
        straight_slope = end_slope * beyond - end * self.deflection_slopes[:, 1]
        force = np.where(above, self.force_ends[:, 1] + end * beyond, np.maximum(force, 0.0))
        stiffness = np.where(above, end, np.maximum(tangent / self.width, 0.0))
        position_slope = np.where(above, straight_slope, self.position_slope(t, tangent))
        return tuple(np.where(lifted, 0.0, values) for values in (force, stiffness, position_slope))

    def deflection(self, force: FloatArray, above: NDArray[np.bool_]) -> FloatArray:
        """Deflection at which the cubic, or above it the straight line, reaches `force`."""
        beyond = (force - self.force_ends[:, 1]) / self.stiffness_ends[:, 1]
        inside = self.deflection_ends[:, 0] + self._fraction(force) * self.width
        return np.where(above, self.deflection_ends[:, 1] + beyond, inside)

    def _fraction(self, force: FloatArray) -> FloatArray:
        """Root t in [0, 1] of the monotone cubic: Newton's method, bisecting where it leaves its bracket."""
        low, high = np.zeros_like(force), np.ones_like(force)
        t = np.clip(
            (force - self.force_ends[:, 0]) / (self.force_ends[:, 1] - self.force_ends[:, 0]), 0.0, 1.0
        )
        for _ in range(80):
            value, tangent = self.cubic(t)
            short = value < force
            low, high = np.where(short, t, low), np.where(short, high, t)
            with np.errstate(divide="ignore", invalid="ignore"):
                newton = t - (value - force) / tangent
            following = np.where((newton > low) & (newton < high), newton, 0.5 * (low + high))
            following = np.where(value == force, t, following)
            step, t = np.abs(following - t), following
            if np.all(step <= 4e-16 * np.maximum(t, 1e-9)):
                break
        return t


@brief
@dataclass(frozen=True, eq=False)
class ForceTable:
    """Levels of constant mesh force over position; read-only arrays."""

    position: FloatArray
    """Knots in transverse base pitches, increasing in [0, period). Shape (P,)."""
    level: FloatArray
    """Transverse mesh force F_bt in N at the levels, increasing, level[0] = 0 (lift-off). Shape (L,)."""
    misalignment: FloatArray
    """m; length 1 = no such axis. Shape (M,)."""
    center_distance_change: FloatArray
    """m; length 1 = no such axis. Shape (D,)."""
    deflection: FloatArray
    """Transmission error at level k in m, increasing in k. Shape (M, D, P, L)."""
    deflection_slope: FloatArray
    """Its derivative in position, m per base pitch. Shape (M, D, P, L)."""
    stiffness: FloatArray
    """dF_bt / d(deflection) in N/m, limited so that the force is monotone; 0 at lift-off. Shape (M, D, P, L).
    """
    stiffness_slope: FloatArray
    """Its derivative in position, N/m per base pitch. Shape (M, D, P, L)."""
    period: int = 1
    """Whole base pitches after which the table repeats."""
    deflection_derivative: FloatArray | None = None
    stiffness_derivative: FloatArray | None = None
    """`deflection_derivative`, `stiffness_derivative`: Differentiated once (1) or not (0) in misalignment,
    center-distance change and position: what the C1 interpolant over all axes uses. None without a second
    knot of misalignment or center distance. Shape (2, 2, 2, M, D, P, L) each.
    """
    load_arm: FloatArray | None = None
    """Arm of the load about the axis of a misalignment at each level, m: from mid-face of the driving gear
    towards its positive z, less tan(beta_b) times the way along the line of action from the pitch point; at
    lift-off that of the lowest load. Shape (M, D, P, L).
    """
    sliding_share: FloatArray | None = None
    sliding_lever: FloatArray | None = None
    """`sliding_share`, `sliding_lever`: Sums over the pairs of load share times the sign of y, and times |y|
    (m): y is the place of a pair's contact from the pitch point, > 0 where it recedes. Shape (M, D, P, L)
    each.
    """

    def __post_init__(self) -> None:
        for entry in fields(self):
            if entry.name == "period" or getattr(self, entry.name) is None:
                continue
            array = np.array(getattr(self, entry.name), dtype=float, order="C")
            array.flags.writeable = False
            object.__setattr__(self, entry.name, array)

    def at_misalignment(self, index: int, misalignment: FloatArray) -> ForceTable:
        """Return the table of one of the misalignments, without that axis, called `misalignment` (1,), m."""
        at = slice(index, index + 1)
        arms = (None if arm is None else arm[at] for arm in self.arms)
        numbers = self.deflection, self.deflection_slope, self.stiffness, self.stiffness_slope
        deflection, across, stiffness, along = (stack[at] for stack in numbers)
        axes = self.position, self.level, misalignment, self.center_distance_change
        return ForceTable(*axes, deflection, across, stiffness, along, self.period, None, None, *arms)

    @property
    def arms(self) -> tuple[FloatArray | None, FloatArray | None, FloatArray | None]:
        """Where the load acts: arm about the axis of a misalignment, share and lever of sliding."""
        return self.load_arm, self.sliding_share, self.sliding_lever
