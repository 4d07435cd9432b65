"""Mesh force as a function of position and deflection, C1 in both, and its exact inverse.

Between two levels the force is a cubic in the deflection with the stored force and tangent stiffness at
both ends; levels and stiffnesses follow position (and misalignment and center distance) by C1 monotone
interpolation. Below the lift-off level the force is zero, above the top level it goes on straight.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntFlag
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bounds import at_least
from fe_contact.errors import InputError
from fe_contact.ste.force_table import ForceCubic, ForceTable
from fe_contact.ste.interpolation import Axis, Stencil, monotone_slopes, ordered_slopes
from fe_contact.ste.level_grid import LevelGrid, deflection_grid, monotone_stiffness, stiffness_grid
from fe_contact.types import FloatArray, IntArray

SlopeRule = Callable[[Axis, FloatArray], FloatArray]
"""Function from an axis and values at its knots, first array axis, to their slopes."""

_BLOCK = 2**17
"""Largest number of queries that are evaluated together: each needs half a kilobyte of memory."""


class Validity(IntFlag):
    """Validity of a force sample; flags add up."""

    INSIDE = 0  # between lift-off and the highest stored load
    LIFTED_OFF = 1  # no contact; the zero force is right
    ABOVE_TABLE = 2  # beyond the highest stored load: straight continuation
    OUTSIDE_MISALIGNMENT = 4  # value of the nearest stored misalignment
    OUTSIDE_CENTER_DISTANCE = 8  # value of the nearest stored center-distance change


@dataclass(frozen=True, eq=False)
class ForceSample:
    """Mesh forces, in the broadcast shape of the query."""

    force: FloatArray
    """Transverse mesh force F_bt in N, >= 0."""
    stiffness: FloatArray
    """dF/d(deflection) in N/m, >= 0."""
    position_slope: FloatArray
    """dF/d(position) at constant deflection, N per base pitch."""
    validity: NDArray[np.int8]
    """Sum of `Validity` flags."""


@dataclass(frozen=True)
class MeshForce:
    """Evaluation of a `ForceTable`."""

    table: ForceTable

    @cached_property
    def axes(self) -> tuple[Axis, Axis, Axis]:
        """Position (periodic), misalignment, center-distance change."""
        table = self.table
        position = Axis(table.position, float(table.period))
        return position, Axis(table.misalignment), Axis(table.center_distance_change)

    @cached_property
    def levels(self) -> LevelGrid:
        """Deflection of the levels over the three axes."""
        values = _position_first(self.table.deflection)
        across = [_along(axis, k, ordered_slopes, values) for k, axis in enumerate(self.axes[1:], start=1)]
        return deflection_grid(self.axes, values, (_position_first(self.table.deflection_slope), *across))

    @cached_property
    def stiffnesses(self) -> LevelGrid:
        """Stiffness at the levels over the three axes."""
        values = _position_first(self.table.stiffness)
        across = [_along(axis, k, monotone_slopes, values) for k, axis in enumerate(self.axes[1:], start=1)]
        grid = stiffness_grid(self.axes, values, (_position_first(self.table.stiffness_slope), *across))
        return monotone_stiffness(grid, self.levels, self.table.level)

    def force_at(
        self,
        position: ArrayLike,
        deflection: ArrayLike,
        misalignment: ArrayLike,
        center_distance_change: ArrayLike,
    ) -> ForceSample:
        """Return force, stiffness, position slope and validity; the arguments broadcast.

        Raises `InputError`: an argument is not finite.
        """
        shape, (x, d, m, c) = _queries(
            position=position,
            deflection=deflection,
            misalignment=misalignment,
            center_distance_change=center_distance_change,
        )
        at = self._stencils(x, m, c)
        lower = self._level_below(at, d)
        lifted, top = lower < 0, lower == len(self.table.level) - 1
        cubic = self._cubic(at, lower)
        force, stiffness, position_slope = cubic.sample(d, lifted, top)
        above = top & (d > cubic.deflection_ends[:, 1])
        validity = _outside_flags(at) + Validity.LIFTED_OFF * lifted + Validity.ABOVE_TABLE * above
        return ForceSample(
            force.reshape(shape),
            stiffness.reshape(shape),
            position_slope.reshape(shape),
            validity.astype(np.int8).reshape(shape),
        )

    def deflection_at(
        self,
        position: ArrayLike,
        force: ArrayLike,
        misalignment: ArrayLike,
        center_distance_change: ArrayLike,
        to_transverse: float = 1.0,
    ) -> tuple[FloatArray, NDArray[np.int8]]:
        """Return the deflection in m at the transverse force `force` * `to_transverse` in N, and validity.

        It is the exact inverse of `force_at`. Raises `InputError`: an argument is not finite, or a force is
        below zero.
        """
        shape, (x, f, m, c) = _queries(
            position=position,
            force=force,
            misalignment=misalignment,
            center_distance_change=center_distance_change,
        )
        if np.any(f < 0.0):
            raise InputError("force", float(f.min()), at_least(0.0, "N"), "Teeth do not pull.")
        deflection, validity = np.empty(f.size), np.empty(f.size, dtype=np.int8)
        for start in range(0, f.size, _BLOCK):
            part = slice(start, start + _BLOCK)
            transverse = f[part] * to_transverse
            deflection[part], validity[part] = self._deflections(transverse, x[part], m[part], c[part])
        return deflection.reshape(shape), validity.reshape(shape)

    def _deflections(
        self, f: FloatArray, x: FloatArray, m: FloatArray, c: FloatArray
    ) -> tuple[FloatArray, NDArray[np.int8]]:
        at = self._stencils(x, m, c)
        lower = np.searchsorted(self.table.level, f, side="right") - 1
        # stored loads are levels: there the deflection needs no cubic
        if np.array_equal(self.table.level[lower], f):
            deflection = self.levels.value(at, lower[:, None])[:, 0]
        else:
            deflection = self._cubic(at, lower).deflection(f, lower == len(self.table.level) - 1)
        validity = _outside_flags(at) + Validity.ABOVE_TABLE * (f > self.table.level[-1])
        return deflection, validity.astype(np.int8)

    def _stencils(self, x: FloatArray, m: FloatArray, c: FloatArray) -> tuple[Stencil, Stencil, Stencil]:
        first, second, third = self.axes
        return first.stencil(x), second.stencil(m), third.stencil(c)

    def _level_below(self, at: tuple[Stencil, ...], d: FloatArray) -> IntArray:
        """Return the highest level not above each deflection, -1 below lift-off.

        The search bisects, since the levels increase.
        """
        low, high = np.full(d.size, -1), np.full(d.size, len(self.table.level))
        while np.any(high - low > 1):
            middle = np.maximum((low + high) // 2, 0)
            reached = self.levels.value(at, middle[:, None])[:, 0] <= d
            low, high = np.where(reached, middle, low), np.where(reached, high, middle)
        return low

    def _cubic(self, at: tuple[Stencil, ...], lower: IntArray) -> ForceCubic:
        """Return the cubic above level `lower` of each query, the nearest one outside the table."""
        columns = np.clip(lower, 0, len(self.table.level) - 2)[:, None] + np.arange(2)
        return ForceCubic(
            deflection_ends=self.levels.value(at, columns),
            deflection_slopes=self.levels.slope(at, columns),
            force_ends=self.table.level[columns],
            stiffness_ends=self.stiffnesses.value(at, columns),
            stiffness_slopes=self.stiffnesses.slope(at, columns),
        )


def _outside_flags(at: tuple[Stencil, Stencil, Stencil]) -> NDArray[np.int64]:
    """Return the flags of queries outside the axes of alignments, as a sum."""
    _, misalignment, center_distance = at
    flags = Validity.OUTSIDE_MISALIGNMENT * misalignment.outside
    return np.asarray(flags + Validity.OUTSIDE_CENTER_DISTANCE * center_distance.outside)


def _queries(**arguments: ArrayLike) -> tuple[tuple[int, ...], list[FloatArray]]:
    """Broadcast the arguments and flatten them; refuse values that are not finite."""
    arrays = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in arguments.values()))
    for name, array in zip(arguments, arrays, strict=True):
        bad = array[~np.isfinite(array)]
        if bad.size:
            raise InputError(name, float(bad[0]), "finite")
    return arrays[0].shape, [array.ravel() for array in arrays]


def _position_first(entry: FloatArray) -> FloatArray:
    """Reorder the axes of an array from (M, D, P, L) to (P, M, D, L)."""
    return np.moveaxis(entry, 2, 0)


def _along(axis: Axis, number: int, rule: SlopeRule, values: FloatArray) -> FloatArray:
    """Return the slopes of values along their array axis `number`, which stands first for the rule."""
    return np.moveaxis(rule(axis, np.moveaxis(values, number, 0)), 0, number)
