"""Errors of a table at points between its nodes of load, misalignment and center distance.

An error at nodes is linear between them. An error of interpolation belongs to an interval: it is zero on its
nodes, and constant elsewhere in it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from fe_contact.ste.fields import SteFields
from fe_contact.ste.interpolation import Axis, Stencil
from fe_contact.types import BoolArray, FloatArray, IntArray

Values = FloatArray
"""Values at the nodes, (F, M, D, ...); values of an interval stand at its lower node."""


@dataclass(frozen=True)
class NodePlaces:
    """Loads, misalignments and center distances of Q points between the nodes of a table.

    Beyond the ends of an axis the end counts.
    """

    force: Stencil
    misalignment: Stencil
    center_distance_change: Stencil

    @classmethod
    def of(
        cls, table: SteFields, force: FloatArray, misalignment: FloatArray, change: FloatArray
    ) -> NodePlaces:
        """Place normal forces in N, misalignments and changes of the center distance in m, each (Q,)."""
        return cls(
            Axis(table.force).stencil(force),
            Axis(table.misalignment).stencil(misalignment),
            Axis(table.center_distance_change).stencil(change),
        )

    @property
    def stencils(self) -> tuple[Stencil, Stencil, Stencil]:
        """Stencils of the three axes."""
        return self.force, self.misalignment, self.center_distance_change

    @property
    def outside(self) -> BoolArray:
        """Whether a point lies beyond an axis of alignments."""
        return np.asarray(self.misalignment.outside | self.center_distance_change.outside)

    def at_nodes(self, values: Values) -> FloatArray:
        """Return errors at nodes (F, M, D, ...) at the points, (Q, ...)."""
        return _linear(self.stencils, values)

    def of_interval(self, values: Values, axis: int) -> FloatArray:
        """Return errors (F, M, D, ...) of the intervals of an axis at the points, (Q, ...)."""
        stencil = self.stencils[axis]
        lower = np.moveaxis(values, axis, 0)[stencil.left]  # (Q, others ...)
        others = [other for i, other in enumerate(self.stencils) if i != axis]
        inside = (stencil.fraction > 0.0) & (stencil.fraction < 1.0)
        points = np.arange(stencil.left.size)
        errors = _linear(others, lower, (points,))
        return np.where(inside.reshape(-1, *[1] * (errors.ndim - 1)), errors, 0.0)

    def interval_error(self, table: SteFields) -> FloatArray:
        """Return the error (Q,) of a point by interpolation along all three axes, m; NaN: not estimated."""
        total = np.zeros(self.force.left.size)
        if table.interval_error.size:
            for axis in np.flatnonzero(np.greater(table.interval_error.shape[1:], 1)).tolist():
                total = total + self.of_interval(table.interval_error[axis], axis)
        return total


def error_band(table: SteFields, position: FloatArray, places: NodePlaces) -> FloatArray:
    """Return the half-width (n,) of the error band of the transmission error at points of a table, m.

    It is the error at the nodes, linear between them, plus the error of interpolation between loads and
    alignments. Below the smallest load the table holds no error. NaN: not estimated.

    Parameters
    ----------
    position : ndarray, shape (n,)
        Positions in base pitches.
    places : NodePlaces
        Loads and alignments of the points, or one for all.
    """
    along_position = Axis(table.position, float(table.period)).stencil(position)
    if places.force.left.size == 1:
        at_knots = places.at_nodes(np.moveaxis(table.error_estimate, 0, 3))[0]  # (P,)
        stored = _linear((along_position,), at_knots)
    else:
        stored = _linear((along_position, *places.stencils), table.error_estimate)
    return np.asarray(stored + places.interval_error(table))


def force_error(table: SteFields, points: FloatArray, force: FloatArray, stiffness: FloatArray) -> FloatArray:
    """Return the error (n,) of mesh forces in N: the error of the transmission error times stiffness.

    NaN where it is not estimated: beyond the axes, above the highest load, below the smallest, without
    contact.

    Parameters
    ----------
    points : ndarray, shape (4, n)
        Positions in base pitches, misalignments, changes of the center distance, deflections, m.
    force, stiffness : ndarray, shape (n,)
        Transverse force in N and its derivative in the deflection, N/m.
    """
    position, misalignment, change, _ = points
    normal = force / math.cos(table.geometry.base_helix_angle)
    places = NodePlaces.of(table, normal, misalignment, change)
    smallest = min([table.force[0], *table.support_force[:1]])
    outside = (normal < smallest) | (normal > table.force[-1]) | places.outside
    return np.where(outside, np.nan, stiffness * error_band(table, position, places))


def _linear(
    stencils: tuple[Stencil, ...] | list[Stencil], values: FloatArray, rows: tuple[IntArray, ...] = ()
) -> FloatArray:
    """Interpolate values linearly over their first axes, (Q, ...); a NaN counts beside its knot only.

    `rows`: indices (Q,) of axes before those of the stencils.
    """
    total: FloatArray | float = 0.0
    # an axis of one node has no right-hand side
    sides = ((0,) if np.array_equal(stencil.left, stencil.right) else (0, 1) for stencil in stencils)
    for corner in product(*sides):
        weight, index = np.ones(stencils[0].left.size), []
        for stencil, side in zip(stencils, corner, strict=True):
            weight = weight * (stencil.fraction if side else 1.0 - stencil.fraction)
            index.append(stencil.right if side else stencil.left)
        term = values[(*rows, *index)]
        weight = weight.reshape(-1, *[1] * (term.ndim - 1))
        total = total + np.where(weight > 0.0, weight * term, 0.0)  # without the NaN of a knot of no weight
    return np.asarray(total)
