"""The load, misalignment and center distance of a query of a table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds import at_most
from fe_contact.errors import InputError, positive, within
from fe_contact.ste.fields import SteFields
from fe_contact.types import FloatArray

FARTHEST = 1000  # periods of a position from the pitch point: load shares have a column for each pair passed


@dataclass(frozen=True)
class OperatingPoint:
    """One load and one alignment inside a table."""

    force: float
    """Total normal tooth force F_bn, N."""
    misalignment: float
    center_distance_change: float
    """`misalignment`, `center_distance_change`: Alignment of the gears, m."""


def operating_point(
    database: SteFields,
    torque: float | None,
    force: float | None,
    misalignment: float | None,
    center_distance_change: float | None,
) -> OperatingPoint:
    """Resolve a question to one point inside the table.

    Raises `InputError`: not exactly one of `torque` and `force` is given, or a value lies outside what is
    stored.
    """
    return OperatingPoint(
        _normal_force(database, torque, force),
        _axis_value("misalignment", misalignment, database.misalignment),
        _axis_value("center_distance_change", center_distance_change, database.center_distance_change),
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
    nodes = np.flatnonzero(np.isclose(stored, value, rtol=1e-12, atol=0.0))
    if nodes.size:
        return float(database.force[nodes[0]])
    if value > stored[-1]:
        bound = at_most(float(stored[-1]), unit, note=", the highest load stored")
        raise InputError(name, value, bound, "Add it to the case.")
    return value if torque is None else database.geometry.normal_force(value)


def _axis_value(name: str, value: float | None, axis: FloatArray) -> float:
    hint = "The table has no such axis; add values to the case." if axis.size == 1 else "Add it to the case."
    return within(name, default_value(value, axis), float(axis[0]), float(axis[-1]), hint)
