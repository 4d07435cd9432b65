"""Compiled look-up of mesh force and tangent stiffness at a position and a deflection."""

from __future__ import annotations

import math

from dynamics.kernels.compiled import compiled, inner
from dynamics.meshes.packed_tables import PackedTables
from dynamics.types import FloatArray


@inner
def cubic(row: FloatArray, index: int, column: int, u: float) -> float:
    """Evaluate the cubic in ``row[index, column : column + 4]`` at u."""
    higher = row[index, column + 1] + u * (row[index, column + 2] + u * row[index, column + 3])
    return float(row[index, column] + u * higher)


@inner
def wrapped(position: float, period: float) -> float:
    """Return `position` in [0, period): whole periods drop exactly."""
    phase = position
    if not 0.0 <= phase < period:
        phase -= period * math.floor(phase / period)
        if not 0.0 <= phase < period:  # a tiny negative phase rounds up to a whole period
            phase = 0.0
    return phase


@inner
def position_interval(table: PackedTables, flank: int, position: float) -> tuple[int, float, float]:
    """Return the first row of the interval that holds `position`, the coordinate in it, 1/width."""
    first, bucket, buckets = table.offset[flank, 0], table.offset[flank, 1], table.offset[flank, 2]
    phase = wrapped(position - table.shift[flank], table.period[flank])
    # rounding may carry a phase just below the period into a bucket behind the last
    interval = table.bucket[bucket + min(int(phase * table.density[flank]), buckets - 1)]
    while phase >= table.knot[first + interval + 1]:
        interval += 1
    start = table.knot[first + interval]
    per_width = 1.0 / (table.knot[first + interval + 1] - start)
    return table.offset[flank, 3] + interval * table.offset[flank, 5], (phase - start) * per_width, per_width


@inner
def level_interval(
    table: PackedTables, flank: int, row: int, u: float, deflection: float, hint: int
) -> tuple[int, float, float]:
    """Return the level k whose interval holds `deflection`, and the deflections at k and k + 1.

    The walk starts at `hint` because a solution moves little between calls. Outside the table k is the first
    or the last interval.
    """
    last = table.offset[flank, 5] - 2
    k = min(max(hint, 0), last)
    low, high = cubic(table.row, row + k, 0, u), cubic(table.row, row + k + 1, 0, u)
    while deflection < low and k > 0:
        k -= 1
        low, high = cubic(table.row, row + k, 0, u), low
    while deflection >= high and k < last:
        k += 1
        low, high = high, cubic(table.row, row + k + 1, 0, u)
    return k, low, high


@compiled
def table_force(
    table: PackedTables, flank: int, position: float, deflection: float, hint: int
) -> tuple[float, float, int]:
    """Return transverse force (N), tangent stiffness (N/m) and the level interval, the next call's hint.

    Zero below lift-off; straight on with the last stiffness above the last level.
    """
    row, u, _ = position_interval(table, flank, position)
    k, low, high = level_interval(table, flank, row, u, deflection, hint)
    if deflection < low:
        return 0.0, 0.0, k
    level = table.offset[flank, 4] + k
    if deflection >= high:
        stiffness = cubic(table.row, row + k + 1, 4, u)
        return table.level[level + 1] + stiffness * (deflection - high), stiffness, k
    span = high - low
    w = (deflection - low) / span
    rise, c2, c3 = force_cubic(table, row + k, level, u, span)
    force = table.level[level] + w * (rise + w * (c2 + w * c3))
    return force, (rise + w * (2.0 * c2 + 3.0 * w * c3)) / span, k


@inner
def force_cubic(
    table: PackedTables, row: int, level: int, u: float, span: float
) -> tuple[float, float, float]:
    """Return the coefficients of w, w^2, w^3 in the force on a level interval of the width `span` (m)."""
    rise, fall = span * cubic(table.row, row, 4, u), span * cubic(table.row, row + 1, 4, u)
    step = table.level[level + 1] - table.level[level]
    return rise, 3.0 * step - 2.0 * rise - fall, rise + fall - 2.0 * step


@compiled
def table_deflection(table: PackedTables, flank: int, position: float, force: float) -> float:
    """Return the deflection (m) at which the table's force is `force` (N); lift-off for 0 or less."""
    row, u, _ = position_interval(table, flank, position)
    first, levels = table.offset[flank, 4], table.offset[flank, 5]
    k, end = 0, levels - 1
    while end - k > 1:  # level k holds, level `end` is above or the last
        middle = (k + end) // 2
        if force >= table.level[first + middle]:
            k = middle
        else:
            end = middle
    low, wanted = cubic(table.row, row + k, 0, u), force - table.level[first + k]
    if wanted <= 0.0:
        return low
    high = cubic(table.row, row + k + 1, 0, u)
    if force >= table.level[first + k + 1]:
        return float(high + (force - table.level[first + k + 1]) / cubic(table.row, row + k + 1, 4, u))
    # Newton, kept inside the bracket: the cubic is monotone on its interval, so bisection can always step in.
    rise, c2, c3 = force_cubic(table, row + k, first + k, u, high - low)
    w, least, most = wanted / (rise + c2 + c3), 0.0, 1.0
    for _ in range(100):
        trial = w * (rise + w * (c2 + w * c3))
        if trial < wanted:
            least = w
        else:
            most = w
        step = (wanted - trial) / (rise + w * (2.0 * c2 + 3.0 * w * c3))
        if not least <= w + step <= most:
            step = 0.5 * (least + most) - w
        w += step
        if abs(step) <= 1e-15:
            break
    return float(low + w * (high - low))
