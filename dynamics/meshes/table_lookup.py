"""Compiled look-up of mesh force, tangent stiffness and deflection in the tables of flanks.

A table has knots of position (base pitches) and levels of force (N). Between two knots the deflection (m) at
a level and the stiffness (N/m) there are cubics in u, 0 to 1: columns 0 to 3 and 4 to 7 of a row of
`table.row`. Between two levels the force is a cubic in w, 0 to 1, the part of the way in deflection.
`table.offset[flank]` has: 0 first knot, 1 first bucket, 2 number of buckets, 3 first row, 4 first level, 5
number of levels, which is also the number of rows of an interval.
"""

from __future__ import annotations

import math

from dynamics.kernels.compiled import compiled, inner
from dynamics.meshes.packed_tables import PackedTables
from dynamics.types import FloatArray


@inner
def cubic_value(row: FloatArray, index: int, column: int, u: float) -> float:
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
    """Return the first row of the interval that holds `position`, the coordinate u in it, and 1/width of it.

    A bucket names the first interval that reaches into it, so that the walk from there is short.
    """
    first, bucket, buckets = table.offset[flank, 0], table.offset[flank, 1], table.offset[flank, 2]
    phase = wrapped(position - table.shift[flank], table.period[flank])
    # rounding may carry a phase just below the period into a bucket behind the last
    interval = table.bucket[bucket + min(int(phase * table.density[flank]), buckets - 1)]
    while phase >= table.knot[first + interval + 1]:
        interval += 1
    per_width = table.per_width[first + interval]
    u = (phase - table.knot[first + interval]) * per_width
    return table.offset[flank, 3] + interval * table.offset[flank, 5], u, per_width


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
    low, high = cubic_value(table.row, row + k, 0, u), cubic_value(table.row, row + k + 1, 0, u)
    while deflection < low and k > 0:
        k -= 1
        low, high = cubic_value(table.row, row + k, 0, u), low
    while deflection >= high and k < last:
        k += 1
        low, high = high, cubic_value(table.row, row + k + 1, 0, u)
    return k, low, high


@compiled
def table_force(
    table: PackedTables, flank: int, position: float, deflection: float, hint: int
) -> tuple[float, float, int]:
    """Return transverse force (N), tangent stiffness (N/m) and the level interval, the next call's hint.

    The force is zero below lift-off. Above the last level it grows with the last stiffness.
    """
    row, u, _ = position_interval(table, flank, position)
    k, low, high = level_interval(table, flank, row, u, deflection, hint)
    if deflection < low:
        return 0.0, 0.0, k
    level = table.offset[flank, 4] + k
    if deflection >= high:
        stiffness = cubic_value(table.row, row + k + 1, 4, u)
        return table.level[level + 1] + stiffness * (deflection - high), stiffness, k
    span = high - low
    w = (deflection - low) / span
    rise, c2, c3 = _force_cubic(table, row + k, level, u, span)
    force = table.level[level] + w * (rise + w * (c2 + w * c3))
    return force, (rise + w * (2.0 * c2 + 3.0 * w * c3)) / span, k


@inner
def _force_cubic(
    table: PackedTables, row: int, level: int, u: float, span: float
) -> tuple[float, float, float]:
    """Return the coefficients of w, w^2, w^3 in the force on a level interval of the width `span` (m).

    They are Hermite's: force and stiffness are those of the table at both levels.
    """
    rise, fall = span * cubic_value(table.row, row, 4, u), span * cubic_value(table.row, row + 1, 4, u)
    step = table.level[level + 1] - table.level[level]
    return rise, 3.0 * step - 2.0 * rise - fall, rise + fall - 2.0 * step


@compiled
def table_deflection(table: PackedTables, flank: int, position: float, force: float) -> float:
    """Return the deflection (m) at which the table's force is `force` (N); lift-off for 0 or less."""
    return deflection_from(table, flank, position, force, level_below(table, flank, force))


@compiled
def read_tangents(
    table: PackedTables, flank: int, position: FloatArray, force: float, stiffness: FloatArray
) -> None:
    """Write the tangent stiffness (P,) at `force` (N) at positions (P,), N/m."""
    for k in range(position.size):
        deflection = table_deflection(table, flank, position[k], force)
        stiffness[k] = table_force(table, flank, position[k], deflection, 0)[1]


@compiled
def level_below(table: PackedTables, flank: int, force: float) -> int:
    """Return the level interval that holds `force` (N): the same at all positions."""
    first = table.offset[flank, 4]
    k, end = 0, table.offset[flank, 5] - 1
    while end - k > 1:  # level k holds, level `end` is above or the last
        middle = (k + end) // 2
        if force >= table.level[first + middle]:
            k = middle
        else:
            end = middle
    return k


@inner
def deflection_from(table: PackedTables, flank: int, position: float, force: float, k: int) -> float:
    """Return the deflection at a force in the level interval `k`, as `table_deflection` does."""
    row, u, _ = position_interval(table, flank, position)
    first = table.offset[flank, 4]
    low, excess = cubic_value(table.row, row + k, 0, u), force - table.level[first + k]
    if excess <= 0.0:
        return float(low)
    high = cubic_value(table.row, row + k + 1, 0, u)
    if force >= table.level[first + k + 1]:
        return float(high + (force - table.level[first + k + 1]) / cubic_value(table.row, row + k + 1, 4, u))
    # Newton's method for w inside a bracket: the cubic is monotone, so that bisection can replace a step.
    # The first guess is the chord; 100 steps are more than bisection needs for w to 1e-15.
    rise, c2, c3 = _force_cubic(table, row + k, first + k, u, high - low)
    w, minimum, maximum = excess / (rise + c2 + c3), 0.0, 1.0
    for _ in range(100):
        trial = w * (rise + w * (c2 + w * c3))
        if trial < excess:
            minimum = w
        else:
            maximum = w
        step = (excess - trial) / (rise + w * (2.0 * c2 + 3.0 * w * c3))
        if not minimum <= w + step <= maximum:
            step = 0.5 * (minimum + maximum) - w
        w += step
        if abs(step) <= 1e-15:
            break
    return float(low + w * (high - low))


@compiled
def deflection_slope(table: PackedTables, flank: int, position: float, force: float) -> float:
    """Return d(deflection)/d(position) at constant `force` > 0, m per base pitch.

    It is -F_x / F_d by the derivatives of the force by position x and deflection d. Slopes are by u.
    """
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
        stiffness = cubic_value(table.row, row + k + 1, 4, u)
        return (high_slope - stiff_end_slope * (deflection - high) / stiffness) * per_width
    span, span_slope = high - low, high_slope - low_slope
    w = (deflection - low) / span
    w_slope = -(low_slope + w * span_slope) / span
    rise_slope = span_slope * cubic_value(table.row, row + k, 4, u) + span * stiff_slope
    fall_slope = span_slope * cubic_value(table.row, row + k + 1, 4, u) + span * stiff_end_slope
    tangent = table_force(table, flank, position, deflection, k)[1]
    force_slope = w * (rise_slope + w * (-2.0 * rise_slope - fall_slope + w * (rise_slope + fall_slope)))
    force_slope += tangent * span * w_slope
    return -force_slope / tangent * per_width


@inner
def cubic_slope(row: FloatArray, index: int, column: int, u: float) -> float:
    """Return the derivative in u of the cubic in ``row[index, column : column + 4]``."""
    return float(
        row[index, column + 1] + u * (2.0 * row[index, column + 2] + 3.0 * u * row[index, column + 3])
    )
