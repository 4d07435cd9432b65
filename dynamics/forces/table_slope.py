"""Compiled derivative in position of the deflection at constant force."""

from __future__ import annotations

from dynamics.forces.compiled import compiled
from dynamics.forces.packed_tables import PackedTables
from dynamics.forces.table_energy import cubic_slope
from dynamics.forces.table_lookup import (
    cubic,
    level_interval,
    position_interval,
    table_deflection,
    table_force,
)


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
