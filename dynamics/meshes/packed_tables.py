"""Mesh-force tables laid out for the compiled look-up.

A level is an elastic force at which the table holds the deflection; a knot is a position. Rows hold the
cubics of all levels in the interval after each knot.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from dynamics.identity_cache import identity_cached
from dynamics.kernels.by_address import by_address, with_numbers
from dynamics.meshes.level_energies import ORDER, energy_below
from dynamics.meshes.mesh_table import MeshTable
from dynamics.types import FloatArray, IntArray

BUCKETS_PER_KNOT = 4  # equal buckets of position per knot, from which a look-up starts
MIN = 4  # least number of knots of a decimated table


@with_numbers("offset")
class PackedTables(NamedTuple):
    """Tables of several flanks, one after the other in flat arrays; flanks of one table share it."""

    offset: IntArray
    """Per flank: first knot, first bucket, number of buckets, first row, first level, number of levels. Shape
    (m, 6).
    """
    shift: FloatArray
    """Position of the first knot. Shape (m,)."""
    period: FloatArray
    """Whole base pitches. Shape (m,)."""
    density: FloatArray
    """Buckets per base pitch. Shape (m,)."""
    knot: FloatArray
    """Knots less `shift`, from 0 to the period inclusive (P + 1 of them). Flat."""
    per_width: FloatArray
    """Inverse of the width of the interval that begins at each knot; 0 at the period. Flat."""
    bucket: IntArray
    """The interval in which each of the equal buckets of the period begins: finding it takes no search."""
    row: FloatArray
    """Per position interval and level the ascending cubic coefficients of deflection (4) and stiffness (4) in
    the local coordinate 0..1: one cache line each. Shape (sum of P L, 8).
    """
    level: FloatArray
    """Forces, N. Flat."""
    energy: FloatArray
    """Coefficients of the energy, see `energy_below`. Shape (sum of P L, 10)."""

    def decimated(self, every: int = 2) -> PackedTables:
        """Return the tables on each `every`-th knot of position, with the values and slopes at these knots.

        Tables that would be left with fewer than `MIN` knots stay as they are.
        """
        _, flank, part_of = np.unique(self.offset[:, 0], return_index=True, return_inverse=True)
        parts = [_decimated_table(_part(self, int(index)), every) for index in flank]
        return _joined_tables(parts, part_of.tolist(), self.shift, self.period)

    def with_table(self, flank: int, table: MeshTable) -> PackedTables:
        """Return the tables with another one of a flank."""
        parts = [_part(self, index) for index in range(len(self.offset))]
        parts[flank] = _laid_out(table)
        shift, period = self.shift.copy(), self.period.copy()
        shift[flank], period[flank] = float(table.position[0]), float(table.period)
        return _joined_tables(parts, range(len(parts)), shift, period)

    def overwrite(self, flank: int, table: MeshTable) -> None:
        """Write another table of the same positions and number of levels into the arrays of a flank's."""
        part = _part(self, flank)
        part.level[:] = table.level
        part.row[:] = _rows(table, np.diff(part.knot))
        part.energy[:] = energy_below(part.row, part.level)


def retained_knots(knots: int, every: int) -> IntArray:
    """Return the knots that stay, and the one that closes the period."""
    indices = np.arange(0, knots, every)
    if indices.size < MIN:
        indices = np.arange(knots)
    return np.append(indices, knots)


class _Table(NamedTuple):
    """One table as `PackedTables` has it: knots from 0 to the period, buckets, rows, levels, energies."""

    knot: FloatArray
    bucket: IntArray
    row: FloatArray
    level: FloatArray
    energy: FloatArray


def _part(tables: PackedTables, flank: int) -> _Table:
    """Return the table of one flank."""
    knot, bucket, buckets, row, level, levels = (int(value) for value in tables.offset[flank])
    intervals = buckets // BUCKETS_PER_KNOT
    rows = slice(row, row + intervals * levels)
    return _Table(
        tables.knot[knot : knot + intervals + 1],
        tables.bucket[bucket : bucket + buckets],
        tables.row[rows],
        tables.level[level : level + levels],
        tables.energy[rows],
    )


def _decimated_table(table: _Table, every: int) -> _Table:
    """Return a table on each `every`-th knot."""
    knot, level = table.knot, table.level
    indices = retained_knots(knot.size - 1, every)
    if indices.size == knot.size:
        return table
    cubic = table.row.reshape(knot.size - 1, level.size, 2, 4)
    start, stop, width = indices[:-1], indices[1:] - 1, np.diff(knot)[:, None, None]
    first, last, span = cubic[start], cubic[stop], np.diff(knot[indices])[:, None, None]
    # Hermite's cubics between retained knots; at the end of a cubic, 1, all its powers are 1
    value, rise = first[..., 0], first[..., 1] / width[start] * span
    fall = (last @ np.array([0.0, 1.0, 2.0, 3.0])) / width[stop] * span
    step = last.sum(axis=-1) - value
    rows = np.stack([value, rise, 3.0 * step - 2.0 * rise - fall, rise + fall - 2.0 * step], axis=-1)
    rows = np.ascontiguousarray(rows.reshape(-1, 8))
    return _Table(knot[indices], _bucket_starts(knot[indices]), rows, level, energy_below(rows, level))


def pack_tables(tables: Sequence[MeshTable]) -> PackedTables:
    """Lay out `tables`, each with misalignment and center-distance axes of length 1."""
    return _packed_tables(tuple(tables))


@identity_cached
def _packed_tables(tables: tuple[MeshTable, ...]) -> PackedTables:
    distinct = {id(table): table for table in tables}  # flanks of one table share its part
    parts = {key: _laid_out(table) for key, table in distinct.items()}
    index = {key: k for k, key in enumerate(parts)}
    shift = np.array([float(table.position[0]) for table in tables])
    period = np.array([float(table.period) for table in tables])
    return by_address(
        _joined_tables([*parts.values()], [index[id(table)] for table in tables], shift, period)
    )


def _joined_tables(
    parts: Sequence[_Table], part_of: Sequence[int], shift: FloatArray, period: FloatArray
) -> PackedTables:
    """Lay out different tables, and of each flank the one it uses: processors keep the rows of few tables."""
    sizes = [(part.knot.size, part.bucket.size, len(part.row), part.level.size) for part in parts]
    starts = np.cumsum([(0, 0, 0, 0), *sizes], axis=0)
    offset = []
    for k in part_of:
        first_knot, first_bucket, first_row, first_level = starts[k]
        buckets, levels = parts[k].bucket.size, parts[k].level.size
        offset.append((first_knot, first_bucket, buckets, first_row, first_level, levels))
    return PackedTables(
        offset=np.array(offset, dtype=np.int64).reshape(-1, 6),
        shift=shift,
        period=period,
        density=np.array([float(parts[k].bucket.size) for k in part_of]) / period,
        knot=joined([part.knot for part in parts], ()),
        per_width=joined([np.append(1.0 / np.diff(part.knot), 0.0) for part in parts], ()),
        bucket=joined([part.bucket for part in parts], ()).astype(np.int64, copy=False),
        row=joined([part.row for part in parts], (8,)),
        level=joined([part.level for part in parts], ()),
        energy=joined([part.energy for part in parts], (ORDER + 1,)),
    )


def joined(arrays: Sequence[FloatArray | IntArray], width: tuple[int, ...]) -> Any:
    """Return arrays (k, *width) one after the other; a single one, which may be large, is not copied."""
    return arrays[0] if len(arrays) == 1 else np.concatenate([*arrays, np.empty((0, *width))])


def _laid_out(table: MeshTable) -> _Table:
    knot = np.append(np.asarray(table.position, dtype=float), table.position[0] + table.period)
    knot -= knot[0]
    rows, level = _rows(table, np.diff(knot)), np.array(table.level, dtype=float)
    return _Table(knot, _bucket_starts(knot), rows, level, energy_below(rows, level))


def _rows(table: MeshTable, width: FloatArray) -> FloatArray:
    """Return the rows (P L, 8) of a table whose intervals have a width (P,)."""
    rows = np.empty((*np.shape(table.deflection)[2:], 2, 4))
    rows[:, :, 0] = _cubic(table.deflection[0, 0], table.deflection_slope[0, 0], width[:, None])
    rows[:, :, 1] = _cubic(table.stiffness[0, 0], table.stiffness_slope[0, 0], width[:, None])
    return rows.reshape(-1, 8)


def _bucket_starts(knot: FloatArray) -> IntArray:
    """Return the interval that holds the start of each bucket; rounding puts it behind no position in it."""
    count = BUCKETS_PER_KNOT * (knot.size - 1)
    start = np.arange(count) / count * (knot[-1] * (1.0 - 1e-12))
    index = np.clip(np.searchsorted(knot, start, side="right") - 1, 0, knot.size - 2)
    return np.asarray(index, dtype=np.int64)


def _cubic(value: FloatArray, slope: FloatArray, width: FloatArray) -> FloatArray:
    """Return coefficients (P, L, 4) on each interval, the last of which joins the last knot to the first."""
    end, rise, fall = np.roll(value, -1, axis=0), slope * width, np.roll(slope, -1, axis=0) * width
    step = end - value
    return np.stack([value, rise, 3.0 * step - 2.0 * rise - fall, rise + fall - 2.0 * step], axis=-1)
