"""Compiled potential energy of a mesh-force table and its derivative in position.

A row of a table has the cubic of the deflection from column 0 on, that of the stiffness from column 4 on.
"""

from __future__ import annotations

from dynamics.kernels.compiled import compiled, inner
from dynamics.meshes.level_energies import ORDER
from dynamics.meshes.packed_tables import PackedTables
from dynamics.meshes.table_lookup import cubic_slope, cubic_value, level_interval, position_interval


@compiled
def table_energy(
    table: PackedTables, flank: int, position: float, deflection: float, hint: int
) -> tuple[float, float]:
    """Return V = integral of the force over the deflection from lift-off, J, and dV/dx, J per base pitch.

    ``PackedTables.energy`` gives the energy of the level intervals below that of `deflection`, which itself
    is integrated up to it.
    """
    row, u, per_width = position_interval(table, flank, position)
    k, low, high = level_interval(table, flank, row, u, deflection, hint)
    if deflection < low:
        return 0.0, 0.0
    energy, slope = energy_below(table, row + k, u)
    low_slope = cubic_slope(table.row, row + k, 0, u)
    high_slope = cubic_slope(table.row, row + k + 1, 0, u)
    span, span_slope = high - low, high_slope - low_slope
    w = min((deflection - low) / span, 1.0)
    w_slope = 0.0 if w == 1.0 else -(low_slope + w * span_slope) / span
    part, change = _interval_energy(table, flank, row, k, u, w, w_slope)
    energy, slope = energy + part, slope + change
    if deflection >= high:
        force = table.level[table.offset[flank, 4] + k + 1]
        stiffness, beyond = cubic_value(table.row, row + k + 1, 4, u), deflection - high
        energy += beyond * (force + 0.5 * stiffness * beyond)
        slope += 0.5 * cubic_slope(table.row, row + k + 1, 4, u) * beyond**2
        slope -= high_slope * (force + stiffness * beyond)
    return energy, slope * per_width


@inner
def energy_below(table: PackedTables, row: int, u: float) -> tuple[float, float]:
    """Return the energy below a level at `u` in a position interval, J, and its derivative in `u`."""
    energy, slope = table.energy[row, ORDER], 0.0
    for power in range(ORDER - 1, -1, -1):
        slope = slope * u + energy
        energy = energy * u + table.energy[row, power]
    return energy, slope


@inner
def _interval_energy(
    table: PackedTables, flank: int, row: int, k: int, u: float, w: float, w_slope: float
) -> tuple[float, float]:
    """Return the energy of level interval k up to its fraction w (dw/du = w_slope), and its slope in u."""
    level = table.offset[flank, 4] + k
    span = cubic_value(table.row, row + k + 1, 0, u) - cubic_value(table.row, row + k, 0, u)
    stiff, stiff_end = cubic_value(table.row, row + k, 4, u), cubic_value(table.row, row + k + 1, 4, u)
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
