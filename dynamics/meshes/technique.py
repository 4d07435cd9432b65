"""The table of a mesh at an operating point, and by its technique: itself, or the secant at one force.

An operating point is a misalignment and a change of center distance. The technique says how the mesh uses its
table: the force by position and deflection, or the secant stiffness at the nominal force.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bounds import from_to
from dynamics.errors import InputError
from dynamics.identity_cache import identity_cached
from dynamics.meshes.mesh_table import DERIVATIVES, LEVERS, MeshTable
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.table_lookup import deflection_slope, table_deflection
from dynamics.types import FloatArray

ROUNDING = 1e-9
"""Relative distance from the end of an axis that unit conversions and digits of files make."""


@dataclass(frozen=True)
class PlainTable:
    """A mesh-force table held as plain arrays; fields as in `MeshTable`, levers None where it has none."""

    position: FloatArray
    level: FloatArray
    misalignment: FloatArray
    center_distance_change: FloatArray
    deflection: FloatArray
    deflection_slope: FloatArray
    stiffness: FloatArray
    stiffness_slope: FloatArray
    period: int = 1
    load_arm: FloatArray | None = None
    sliding_share: FloatArray | None = None
    sliding_lever: FloatArray | None = None
    deflection_derivative: FloatArray | None = None
    stiffness_derivative: FloatArray | None = None


@identity_cached
def table_at(table: MeshTable, misalignment: float, center_distance_change: float) -> PlainTable:
    """Return `table` at one misalignment and center-distance change, linear between their knots.

    Raises `InputError`: the operating point is outside the table, or not the table's only one.
    """
    weight_m = _weights("misalignment", table.misalignment, misalignment)
    weight_d = _weights("center_distance_change", table.center_distance_change, center_distance_change)
    alone = weight_m.size == weight_d.size == 1

    def coefficient(name: str) -> FloatArray:
        values = np.asarray(getattr(table, name), dtype=float)
        if alone:
            return values
        return np.asarray(np.einsum("m,d,mdpl->pl", weight_m, weight_d, values)[None, None])

    return PlainTable(
        position=np.asarray(table.position, dtype=float),
        level=np.asarray(table.level, dtype=float),
        misalignment=np.array([misalignment]),
        center_distance_change=np.array([center_distance_change]),
        deflection=coefficient("deflection"),
        deflection_slope=coefficient("deflection_slope"),
        stiffness=coefficient("stiffness"),
        stiffness_slope=coefficient("stiffness_slope"),
        period=table.period,
        **{name: coefficient(name) for name in _present(table, LEVERS)},
    )


def _present(table: MeshTable, names: Sequence[str]) -> dict[str, FloatArray]:
    """Return the optional quantities of a table that it has, by name."""
    values = {name: getattr(table, name, None) for name in names}
    return {name: value for name, value in values.items() if value is not None}


@identity_cached
def secant_table(table: PlainTable, force: float) -> PlainTable:
    """Return the two-level table of F = k(x) d with k(x) = force / STE(x), both at the knots of `table`.

    Raises `InputError`: the static transmission error at that force is not above zero everywhere.
    """
    packed = pack_tables([table])
    position = table.position
    ste = np.array([table_deflection(packed, 0, x, force) for x in position])
    slope = np.array([deflection_slope(packed, 0, x, force) for x in position])
    if not np.all(ste > 0.0):
        raise InputError(
            "nominal_force", force, "a force at which the transmission error is above 0 everywhere"
        )
    zero, stiffness = np.zeros_like(ste), force / ste
    weight = _linear_weights(table.level, force)[:, None]
    stiffness_slope = -stiffness * slope / ste

    def shaped(first: FloatArray, second: FloatArray) -> FloatArray:
        return np.stack([first, second], axis=-1)[None, None]

    return PlainTable(
        position=position,
        level=np.array([0.0, force]),
        misalignment=table.misalignment,
        center_distance_change=table.center_distance_change,
        deflection=shaped(zero, ste),
        deflection_slope=shaped(zero, slope),
        stiffness=shaped(stiffness, stiffness),
        stiffness_slope=shaped(stiffness_slope, stiffness_slope),
        period=table.period,
        **{name: np.repeat(lever @ weight, 2, axis=-1) for name, lever in _present(table, LEVERS).items()},
    )


def _weights(field: str, knots: FloatArray, value: float) -> FloatArray:
    """Return the weights of the knots at a value; beyond an end by no more than rounding it is that end."""
    knots = np.atleast_1d(np.asarray(knots, dtype=float))
    inside = float(np.clip(value, knots[0], knots[-1]))
    if math.isclose(value, inside, rel_tol=ROUNDING):
        value = inside
    if not knots[0] <= value <= knots[-1]:
        bound = from_to(float(knots[0]), float(knots[-1]), "m", note=", the table's")
        raise InputError(field, value, bound, "Compute the table for this operating point.")
    return _linear_weights(knots, value)


def _linear_weights(knots: FloatArray, value: float) -> FloatArray:
    """Return the weights of the knots in linear interpolation: each is the interpolant of a unit vector."""
    return np.array([np.interp(value, knots, unit) for unit in np.eye(knots.size)])


def table_at_operating_point(
    table: MeshTable, misalignment: float, center_distance_change: float
) -> PlainTable:
    """Return `table` at one misalignment and center-distance change in m; ends are held beyond the axes.

    Needs the table's derivatives along axes of more than one knot.
    """
    m = _hermite_weights(np.asarray(table.misalignment, dtype=float), misalignment)
    a = _hermite_weights(np.asarray(table.center_distance_change, dtype=float), center_distance_change)

    def coefficient(name: str, order: int) -> FloatArray:
        derivative = getattr(table, f"{name}_derivative", None)
        if derivative is None:
            return np.asarray(getattr(table, name if order == 0 else f"{name}_slope"), dtype=float)
        values = np.einsum("um,vd,uvmdpl->pl", m, a, np.asarray(derivative, dtype=float)[:, :, order])
        return np.asarray(values[None, None])

    return PlainTable(
        position=np.asarray(table.position, dtype=float),
        level=np.asarray(table.level, dtype=float),
        misalignment=np.array([misalignment]),
        center_distance_change=np.array([center_distance_change]),
        deflection=coefficient("deflection", 0),
        deflection_slope=coefficient("deflection", 1),
        stiffness=coefficient("stiffness", 0),
        stiffness_slope=coefficient("stiffness", 1),
        period=table.period,
    )


def _hermite_weights(knots: FloatArray, at: float) -> FloatArray:
    """Return the weights of values and slopes at `knots` (k,) in Hermite's interpolation, (2, k)."""
    weight = np.zeros((2, knots.size))
    if knots.size == 1:
        weight[0, 0] = 1.0
        return weight
    left = int(np.clip(np.searchsorted(knots, at, side="right") - 1, 0, knots.size - 2))
    width = knots[left + 1] - knots[left]
    u = float(np.clip((at - knots[left]) / width, 0.0, 1.0))
    s = 1.0 - u
    weight[:, left] = (1.0 + 2.0 * u) * s * s, width * u * s * s
    weight[:, left + 1] = u * u * (3.0 - 2.0 * u), -width * u * u * s
    return weight


def mirrored(table: MeshTable, thickness: float) -> PlainTable:
    """Return `table` with its positions x replaced by thickness - x, at the same forces and deflections."""
    position = np.mod(thickness - table.position, float(table.period))
    position[position >= table.period] = 0.0  # a tiny negative one rounds up to a whole period
    order = np.argsort(position)
    sign = np.array([1.0, -1.0]).reshape(2, 1, 1, 1, 1)  # of values, and of derivatives in position

    def reordered(values: FloatArray) -> FloatArray:
        return np.ascontiguousarray(np.take(values, order, axis=-2))

    return PlainTable(
        position=position[order],
        level=table.level,
        misalignment=table.misalignment,
        center_distance_change=table.center_distance_change,
        deflection=reordered(table.deflection),
        deflection_slope=-reordered(table.deflection_slope),
        stiffness=reordered(table.stiffness),
        stiffness_slope=-reordered(table.stiffness_slope),
        period=table.period,
        **{name: reordered(values) for name, values in _present(table, LEVERS).items()},
        **{name: sign * reordered(values) for name, values in _present(table, DERIVATIVES).items()},
    )
