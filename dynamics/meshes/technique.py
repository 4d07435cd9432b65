"""The table by a mesh's technique: the table itself, or the secant stiffness at one force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds import from_to
from dynamics.errors import InputError
from dynamics.identity_cache import identity_cached
from dynamics.kernels.compiled import compiled, inner
from dynamics.meshes.mesh_table import LEVERS, MeshTable
from dynamics.meshes.packed_tables import ORDER, PackedTables, pack_tables
from dynamics.meshes.table_lookup import (
    cubic,
    level_interval,
    position_interval,
    table_deflection,
    table_force,
)
from dynamics.types import FloatArray

# Compiled potential energy of a mesh-force table and its derivative in position.


@inner
def cubic_slope(row: FloatArray, index: int, column: int, u: float) -> float:
    """Return the derivative in u of the cubic in ``row[index, column : column + 4]``."""
    return float(
        row[index, column + 1] + u * (2.0 * row[index, column + 2] + 3.0 * u * row[index, column + 3])
    )


@compiled
def table_energy(
    table: PackedTables, flank: int, position: float, deflection: float, hint: int
) -> tuple[float, float]:
    """Return V = integral of the force over the deflection from lift-off, J, and dV/dx, J per base pitch.

    The intervals below hold ``PackedTables.energy``; the last one is integrated up to `deflection`.
    """
    row, u, per_width = position_interval(table, flank, position)
    k, low, high = level_interval(table, flank, row, u, deflection, hint)
    if deflection < low:
        return 0.0, 0.0
    energy, slope = _energy_below(table, row + k, u)
    low_slope = cubic_slope(table.row, row + k, 0, u)
    high_slope = cubic_slope(table.row, row + k + 1, 0, u)
    span, span_slope = high - low, high_slope - low_slope
    w = min((deflection - low) / span, 1.0)
    w_slope = 0.0 if w == 1.0 else -(low_slope + w * span_slope) / span
    part, change = _interval_energy(table, flank, row, k, u, w, w_slope)
    energy, slope = energy + part, slope + change
    if deflection >= high:
        force = table.level[table.offset[flank, 4] + k + 1]
        stiffness, beyond = cubic(table.row, row + k + 1, 4, u), deflection - high
        energy += beyond * (force + 0.5 * stiffness * beyond)
        slope += 0.5 * cubic_slope(table.row, row + k + 1, 4, u) * beyond**2
        slope -= high_slope * (force + stiffness * beyond)
    return energy, slope * per_width


@inner
def _energy_below(table: PackedTables, row: int, u: float) -> tuple[float, float]:
    energy, slope = table.energy[row, ORDER], 0.0
    for power in range(ORDER - 1, -1, -1):
        slope = slope * u + energy
        energy = energy * u + table.energy[row, power]
    return energy, slope


@inner
def _interval_energy(
    table: PackedTables, flank: int, row: int, k: int, u: float, w: float, w_slope: float
) -> tuple[float, float]:
    """Energy and its derivative in u of level interval k, up to the fraction w of it (dw/du = w_slope)."""
    level = table.offset[flank, 4] + k
    span = cubic(table.row, row + k + 1, 0, u) - cubic(table.row, row + k, 0, u)
    stiff, stiff_end = cubic(table.row, row + k, 4, u), cubic(table.row, row + k + 1, 4, u)
    span_slope = cubic_slope(table.row, row + k + 1, 0, u) - cubic_slope(table.row, row + k, 0, u)
    stiff_slope = cubic_slope(table.row, row + k, 4, u)
    stiff_end_slope = cubic_slope(table.row, row + k + 1, 4, u)
    start, step = table.level[level], table.level[level + 1] - table.level[level]
    # force on the interval: start + rise w + c2 w^2 + c3 w^3
    rise, fall = span * stiff, span * stiff_end
    rise_slope = span_slope * stiff + span * stiff_slope
    fall_slope = span_slope * stiff_end + span * stiff_end_slope
    c2, c3 = 3.0 * step - 2.0 * rise - fall, rise + fall - 2.0 * step
    area = w * (start + w * (rise / 2.0 + w * (c2 / 3.0 + w * c3 / 4.0)))
    force = start + w * (rise + w * (c2 + w * c3))
    change = rise_slope / 2.0 + w * (
        -(2.0 * rise_slope + fall_slope) / 3.0 + w * (rise_slope + fall_slope) / 4.0
    )
    return span * area, span_slope * area + span * (force * w_slope + w * w * change)


# Compiled derivative in position of the deflection at constant force.


@compiled
def deflection_slope(table: PackedTables, flank: int, position: float, force: float) -> float:
    """Return d(deflection)/d(position) at constant `force` > 0, m per base pitch: -F_x / F_d."""
    deflection = table_deflection(table, flank, position, force)
    row, u, per_width = position_interval(table, flank, position)
    k, low, high = level_interval(table, flank, row, u, deflection, 0)
    low_slope = cubic_slope(table.row, row + k, 0, u)
    high_slope = cubic_slope(table.row, row + k + 1, 0, u)
    stiff_slope, stiff_end_slope = (
        cubic_slope(table.row, row + k, 4, u),
        cubic_slope(table.row, row + k + 1, 4, u),
    )
    if deflection >= high:
        stiffness = cubic(table.row, row + k + 1, 4, u)
        return (high_slope - stiff_end_slope * (deflection - high) / stiffness) * per_width
    span, span_slope = high - low, high_slope - low_slope
    w = (deflection - low) / span
    w_slope = -(low_slope + w * span_slope) / span
    rise_slope = span_slope * cubic(table.row, row + k, 4, u) + span * stiff_slope
    fall_slope = span_slope * cubic(table.row, row + k + 1, 4, u) + span * stiff_end_slope
    tangent = table_force(table, flank, position, deflection, k)[1]
    force_slope = w * (rise_slope + w * (-2.0 * rise_slope - fall_slope + w * (rise_slope + fall_slope)))
    force_slope += tangent * span * w_slope
    return -force_slope / tangent * per_width


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
    face_centroid: FloatArray | None = None
    sliding_share: FloatArray | None = None
    sliding_lever: FloatArray | None = None
    deflection_derivative: FloatArray | None = None
    stiffness_derivative: FloatArray | None = None


@identity_cached
def table_at(table: MeshTable, misalignment: float, center_distance_change: float) -> PlainTable:
    """Return `table` at one misalignment and center-distance change, linear between their knots.

    Raises
    ------
    InputError
        If the operating point is outside the table, or not the table's only one.
    """
    weight_m = _weights("misalignment", table.misalignment, misalignment)
    weight_d = _weights("center_distance_change", table.center_distance_change, center_distance_change)

    def here(name: str) -> FloatArray:
        values = np.asarray(getattr(table, name), dtype=float)
        return np.asarray(np.einsum("m,d,mdpl->pl", weight_m, weight_d, values)[None, None])

    levers = {name: here(name) for name in LEVERS if getattr(table, name, None) is not None}

    return PlainTable(
        np.asarray(table.position, dtype=float),
        np.asarray(table.level, dtype=float),
        np.array([misalignment]),
        np.array([center_distance_change]),
        here("deflection"),
        here("deflection_slope"),
        here("stiffness"),
        here("stiffness_slope"),
        table.period,
        **levers,
    )


@identity_cached
def secant_table(table: PlainTable, force: float) -> PlainTable:
    """Return the two-level table of F = k(x) d with k(x) = force / STE(x), both at the knots of `table`.

    Raises
    ------
    InputError
        If the static transmission error at that force is not above zero everywhere.
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
    stiffness_slope = -stiffness * slope / ste

    def shaped(first: FloatArray, second: FloatArray) -> FloatArray:
        return np.stack([first, second], axis=-1)[None, None]

    return PlainTable(
        position,
        np.array([0.0, force]),
        table.misalignment,
        table.center_distance_change,
        shaped(zero, ste),
        shaped(zero, slope),
        shaped(stiffness, stiffness),
        shaped(stiffness_slope, stiffness_slope),
        table.period,
        **{
            name: np.repeat(_at_force(table.level, values, force), 2, axis=-1)
            for name in LEVERS
            if (values := getattr(table, name)) is not None
        },
    )


def _at_force(level: FloatArray, values: FloatArray, force: float) -> FloatArray:
    """Return a lever (M, D, P, L) at one force, (M, D, P, 1), linear between the levels."""
    weight = [np.interp(force, level, unit) for unit in np.eye(level.size)]
    return np.asarray(values @ np.array(weight)[:, None])


def _weights(field: str, knots: FloatArray, value: float) -> FloatArray:
    knots = np.atleast_1d(np.asarray(knots, dtype=float))
    if not knots[0] <= value <= knots[-1]:
        bound = from_to(float(knots[0]), float(knots[-1]), "m", note=", the table's")
        raise InputError(field, value, bound, "Compute the table for this operating point.")
    return np.array([np.interp(value, knots, unit) for unit in np.eye(knots.size)])
