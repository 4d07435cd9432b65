"""Errors of mean, peak-to-peak and harmonics by source, as a table stores them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds import at_most
from fe_contact.errors import InputError, positive, within
from fe_contact.ste.curve_quantities import QUANTITIES
from fe_contact.ste.fields import SteFields
from fe_contact.types import FloatArray

# The load, misalignment and center distance of a query.


@dataclass(frozen=True)
class OperatingPoint:
    """One load and one alignment inside a table.

    Attributes
    ----------
    force : float
        Total normal tooth force F_bn, N.
    misalignment, center_distance_change : float
        m.
    """

    force: float
    misalignment: float
    center_distance_change: float


def operating_point(
    database: SteFields,
    torque: float | None,
    force: float | None,
    misalignment: float | None,
    center_distance_change: float | None,
) -> OperatingPoint:
    """Resolve a question to one point inside the table.

    Raises
    ------
    InputError
        If not exactly one of `torque` and `force` is given, or a value lies outside what is stored.
    """
    return OperatingPoint(
        _normal_force(database, torque, force),
        _inside("misalignment", misalignment, database.misalignment),
        _inside("center_distance_change", center_distance_change, database.center_distance_change),
    )


def default_value(value: float | None, axis: FloatArray) -> float:
    """Return the value; without one zero, or the only value of an axis of length 1."""
    if value is not None:
        return value
    return float(axis[0]) if axis.size == 1 else 0.0


def _normal_force(database: SteFields, torque: float | None, force: float | None) -> float:
    """Return the load as F_bn in N; a stored torque gives exactly its stored force."""
    if (torque is None) == (force is None):
        raise InputError("torque, force", (torque, force), "exactly one of the two")
    if torque is not None:
        name, unit, stored, value = "torque", "N m", database.torque, positive("torque", torque)
    else:
        name, unit, stored, value = "force", "N", database.force, positive("force", force or 0.0)
    known = np.flatnonzero(np.isclose(stored, value, rtol=1e-12, atol=0.0))
    if known.size:
        return float(database.force[known[0]])
    if value > stored[-1]:
        bound = at_most(float(stored[-1]), unit, note=", the highest load stored")
        raise InputError(name, value, bound, "Add it to the case.")
    return value if torque is None else database.facts.normal_force(value)


def _inside(name: str, value: float | None, axis: FloatArray) -> float:
    hint = "The table has no such axis; add values to the case." if axis.size == 1 else "Add it to the case."
    return within(name, default_value(value, axis), float(axis[0]), float(axis[-1]), hint)


AT_NODES = ("discretisation", "slices", "contact_solver", "finite_width", "position", "model")
"""Sources that act at stored loads and alignments as well."""
BETWEEN_NODES = ("force", "misalignment", "center_distance_change")
"""Interpolation along each axis: nothing on its nodes; stored at the lower node of every interval."""
SOURCES = AT_NODES + BETWEEN_NODES


def errors_by_source(table: SteFields, point: OperatingPoint) -> FloatArray:
    """Return the errors of the quantities (sources, 22) in m at one load and alignment.

    Linear between the nodes. NaN: not estimated.
    """
    values = np.moveaxis(table.curve_error, (2, 3, 4), (0, 1, 2))
    at_nodes = values[:, :, :, : len(AT_NODES)]
    between = []
    axes = (
        (table.force, point.force),
        (table.misalignment, point.misalignment),
        (table.center_distance_change, point.center_distance_change),
    )
    for knots, at in axes:
        at_nodes = _linear(knots, at_nodes, at)
    for i, source in enumerate(range(len(AT_NODES), len(SOURCES))):
        knots, at = axes[i]
        inside = at not in knots and knots[0] < at < knots[-1]
        between.append(_interval(values[..., source, :], axes, i) if inside else np.zeros(QUANTITIES))
    return np.concatenate([at_nodes, np.array(between)])


def all_sources(errors: FloatArray) -> FloatArray:
    """Return the error (22,) of all sources (sources, 22) together, m: the root of the sum of their squares.

    Meshes, slices, positions and nodes of the axes know nothing of each other, so that their errors are as
    likely to cancel as to add up. A sum states a third more and holds hardly more often (docs/accuracy.md).
    """
    return np.asarray(np.sqrt(np.square(errors).sum(axis=0)))


def _linear(knots: FloatArray, values: FloatArray, at: float) -> FloatArray:
    """Interpolate values (K, ...) linearly, held beyond the ends; a knot is not touched by its neighbors."""
    left = int(np.clip(np.searchsorted(knots, at, side="right") - 1, 0, knots.size - 1))
    if left == knots.size - 1 or at <= knots[left]:
        return np.asarray(values[left])
    part = (at - knots[left]) / (knots[left + 1] - knots[left])
    return np.asarray((1.0 - part) * values[left] + part * values[left + 1])


def _interval(values: FloatArray, axes: tuple[tuple[FloatArray, float], ...], axis: int) -> FloatArray:
    """Errors (22,) of the interval of one axis that holds the point, linear along the other two."""
    knots, at = axes[axis]
    values = np.moveaxis(values, axis, 0)[int(np.searchsorted(knots, at)) - 1]
    for i, (others, where) in enumerate(axes):
        values = values if i == axis else _linear(others, values, where)
    return values
