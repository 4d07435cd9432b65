"""Packed tables on every second position: the influence of the nodes between them."""

from __future__ import annotations

import numpy as np

from dynamics.meshes.grid_tables import GridTables
from dynamics.meshes.packed_tables import ORDER, PackedTables, bucket_starts, energy_below
from dynamics.types import FloatArray, IntArray

LEAST = 4  # knots of a table that can be decimated


def decimated(tables: PackedTables, every: int = 2) -> PackedTables:
    """Return `tables` on each `every`-th knot of position, with the values and slopes they have there.

    Tables of fewer than LEAST knots in what is left stay as they are.
    """
    parts = [_flank(tables, flank, every) for flank in range(tables.period.size)]
    starts = [np.cumsum([0, *(len(part[k]) for part in parts)]) for k in range(3)]
    offset = tables.offset.copy()
    for flank, part in enumerate(parts):
        offset[flank, :4] = starts[0][flank], starts[1][flank], len(part[1]), starts[2][flank]
    row = np.ascontiguousarray(np.concatenate([*(part[2] for part in parts), np.empty((0, 8))]))
    levels = [tables.level[first : first + count] for first, count in tables.offset[:, 4:]]
    energies = [energy_below(part[2], level) for part, level in zip(parts, levels, strict=True)]
    return tables._replace(
        offset=offset,
        density=np.array([float(len(part[1])) for part in parts]) / tables.period,
        knot=np.concatenate([*(part[0] for part in parts), np.empty(0)]),
        bucket=np.concatenate([*(part[1] for part in parts), np.empty(0, dtype=np.int64)]),
        row=row,
        energy=np.concatenate([*energies, np.empty((0, ORDER + 1))]),
    )


def decimated_grids(grids: GridTables, every: int = 2) -> GridTables:
    """Return `grids` on each `every`-th knot of position."""
    shape, first = grids.shape.copy(), grids.first.copy()
    numbers: list[FloatArray] = []
    for flank in range(len(grids.first)):
        m, a, knots = (int(size) for size in grids.shape[flank])
        levels, channels = int(grids.base.offset[flank, 5]), int(grids.channels[flank])
        orders = 2 * min(m, 2) * min(a, 2)
        size = m * a * knots * levels * channels * orders
        number = grids.number[grids.first[flank] : grids.first[flank] + size]
        kept = _kept(knots, every)[:-1]
        number = number.reshape(m * a, knots, levels * channels * orders)[:, kept]
        first[flank] = sum(part.size for part in numbers)
        shape[flank, 2] = kept.size
        numbers.append(number.ravel())
    return grids._replace(
        base=decimated(grids.base, every),
        shape=shape,
        first=first,
        number=np.concatenate([*numbers, np.empty(0)]),
    )


def _kept(knots: int, every: int) -> IntArray:
    """Return the knots that stay, and the one that closes the period."""
    kept = np.arange(0, knots, every)
    if kept.size < LEAST:
        kept = np.arange(knots)
    return np.append(kept, knots)


def _flank(tables: PackedTables, flank: int, every: int) -> tuple[FloatArray, IntArray, FloatArray]:
    """Return knots, buckets and rows of one table."""
    first, bucket, buckets, row, _, levels = (int(value) for value in tables.offset[flank])
    intervals = (tables.offset[flank + 1, 3] if flank + 1 < len(tables.offset) else len(tables.row)) - row
    intervals = int(intervals) // levels
    knot = tables.knot[first : first + intervals + 1]
    kept = _kept(intervals, every)
    if kept.size == intervals + 1:
        return knot, tables.bucket[bucket : bucket + buckets], tables.row[row : row + intervals * levels]
    cubic = tables.row[row : row + intervals * levels].reshape(intervals, levels, 2, 4)
    width = np.diff(knot)[:, None, None]
    left, left_slope = cubic[..., 0], cubic[..., 1] / width
    end, end_slope = cubic.sum(axis=-1), (cubic @ np.array([0.0, 1.0, 2.0, 3.0])) / width
    span = np.diff(knot[kept])[:, None, None]
    start, stop = kept[:-1], kept[1:] - 1
    value, rise, fall = left[start], left_slope[start] * span, end_slope[stop] * span
    step = end[stop] - value
    rows = np.stack([value, rise, 3.0 * step - 2.0 * rise - fall, rise + fall - 2.0 * step], axis=-1)
    return knot[kept], bucket_starts(knot[kept]), rows.reshape(-1, 8)
