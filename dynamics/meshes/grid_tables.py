"""Mesh-force tables over position, misalignment and center distance, laid out for the compiled look-up."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from dynamics.identity_cache import identity_cached
from dynamics.meshes.mesh_table import LEVERS, MeshTable
from dynamics.meshes.packed_tables import PackedTables, joined, pack_tables, retained_knots
from dynamics.types import FloatArray, IntArray


class GridTables(NamedTuple):
    """Tables of k flanks, one after the other in flat arrays."""

    base: PackedTables
    """Knots of position and levels, and the first knot of the other axes."""
    shape: IntArray
    """Knots of misalignment, center distance and position. Shape (k, 3)."""
    channels: IntArray
    """Quantities per level: deflection, stiffness, then the value and slope in force of each lever. Shape
    (k,).
    """
    axis_first: IntArray
    """First knot of misalignment and center distance in `axis`. Shape (k, 2)."""
    axis: FloatArray
    """Knots of misalignment and center distance of all tables, m. Flat."""
    first: IntArray
    """First number of each table. Shape (k,)."""
    number: FloatArray
    """Numbers of all tables by misalignment, center distance, position, level, channel and order of
    differentiation: in misalignment and center distance (where they have a second knot), then in position.
    Flat.
    """

    @classmethod
    def packed(cls, tables: Sequence[MeshTable]) -> GridTables:
        """Lay out `tables`; those with several operating points carry their derivatives along the axes."""
        return _packed_tables(tuple(tables))

    @classmethod
    def _layout(cls, tables: Sequence[MeshTable]) -> GridTables:
        by_id = {id(table): table for table in tables}  # flanks of one table share its numbers
        numbers = {key: _numbers(table) for key, table in by_id.items()}
        ends = np.cumsum([number.size for number in numbers.values()])
        begins = {key: end - numbers[key].size for key, end in zip(by_id, ends, strict=True)}
        axes, shape = [], []
        for table in tables:
            axes += [np.ravel(table.misalignment), np.ravel(table.center_distance_change)]
            shape.append([axes[-2].size, axes[-1].size, np.size(table.position)])
        starts = np.cumsum([0, *(axis.size for axis in axes)])[:-1].reshape(-1, 2)
        return cls(
            base=pack_tables(tables),
            shape=np.array(shape, dtype=np.int64).reshape(-1, 3),
            channels=np.array([numbers[id(table)].shape[4] for table in tables], dtype=np.int64),
            axis_first=np.ascontiguousarray(starts, dtype=np.int64),
            axis=np.concatenate([*axes, np.empty(0)]).astype(float),
            first=np.array([begins[id(table)] for table in tables], dtype=np.int64),
            number=joined([number.ravel() for number in numbers.values()], ()),
        )

    def with_table(self, flank: int, table: MeshTable) -> GridTables:
        """Return the tables with another one of a flank, behind all others."""
        layout = GridTables._layout([table])
        tables = GridTables(
            base=self.base.with_table(flank, table),
            shape=self.shape.copy(),
            channels=self.channels.copy(),
            axis_first=self.axis_first.copy(),
            axis=np.concatenate([self.axis, layout.axis]),
            first=self.first.copy(),
            number=np.concatenate([self.number, layout.number]),
        )
        tables.shape[flank], tables.channels[flank] = layout.shape[0], layout.channels[0]
        tables.axis_first[flank] = layout.axis_first[0] + self.axis.size
        tables.first[flank] = self.number.size
        return tables

    def overwrite(self, flank: int, table: MeshTable) -> None:
        """Write another table as `PackedTables.overwrite` does."""
        number, first = _numbers(table), int(self.first[flank])
        self.number[first : first + number.size] = number.ravel()
        self.base.overwrite(flank, table)

    def decimated(self, every: int = 2) -> GridTables:
        """Return the tables on each `every`-th knot of position."""
        shape, first = self.shape.copy(), self.first.copy()
        numbers: list[FloatArray] = []
        for begin, flank in zip(*np.unique(self.first, return_index=True), strict=True):
            m, a, knots = (int(size) for size in self.shape[flank])
            levels, channels = int(self.base.offset[flank, 5]), int(self.channels[flank])
            orders = 2 * min(m, 2) * min(a, 2)
            size = m * a * knots * levels * channels * orders
            number = self.number[self.first[flank] : self.first[flank] + size]
            retained = retained_knots(knots, every)[:-1]
            number = number.reshape(m * a, knots, levels * channels * orders)[:, retained]
            alike = self.first == begin
            first[alike], shape[alike, 2] = sum(part.size for part in numbers), retained.size
            numbers.append(number.ravel())
        return self._replace(
            base=self.base.decimated(every),
            shape=shape,
            first=first,
            number=np.concatenate([*numbers, np.empty(0)]),
        )


@identity_cached
def _packed_tables(tables: tuple[MeshTable, ...]) -> GridTables:
    return GridTables._layout(tables)


def _numbers(table: MeshTable) -> FloatArray:
    """Return the numbers of a table, (M, D, P, L, channels, orders)."""
    shape = np.shape(table.deflection)
    orders = list(product(*((0, 1) if size > 1 else (0,) for size in shape[:2]), (0, 1)))
    numbers = np.empty((*shape, 2 + 2 * len(LEVERS), len(orders)))
    for channel, values in enumerate(_channels(table)):  # one at a time: tables of long periods are large
        for column, order in enumerate(orders):
            numbers[..., channel, column] = values[order]
    return numbers


def _channels(table: MeshTable) -> Iterator[FloatArray]:
    """Yield the quantities with their derivatives, each (1 or 2, 1 or 2, 2, M, D, P, L)."""
    for name in ("deflection", "stiffness"):
        yield _values_of(table, name)
    for name in LEVERS:
        values = getattr(table, name, None)
        lever = np.zeros(np.shape(table.deflection)) if values is None else np.asarray(values, dtype=float)
        yield _smooth(table, lever)
        in_force = np.gradient(lever, np.asarray(table.level, dtype=float), axis=3)
        in_force[..., 0], in_force[..., -1] = 0.0, 0.0  # beyond the ends it stays as it is
        yield _smooth(table, in_force)


def _no_derivatives(values: FloatArray) -> FloatArray:
    """Return values (M, D, P, L) with zeros for their derivatives along axes of several knots."""
    numbers = np.zeros((*(min(size, 2) for size in values.shape[:2]), 2, *values.shape))
    numbers[0, 0, 0] = values
    return numbers


def _values_of(table: MeshTable, name: str) -> FloatArray:
    """Return a quantity with the derivatives that the table gives, (1 or 2, 1 or 2, 2, M, D, P, L)."""
    derivative = getattr(table, f"{name}_derivative", None)
    if derivative is not None:
        return np.asarray(derivative, dtype=float)
    values = np.asarray(getattr(table, name), dtype=float)
    numbers = _no_derivatives(values)
    numbers[0, 0, 1] = getattr(table, f"{name}_slope")
    return numbers


def _smooth(table: MeshTable, values: FloatArray) -> FloatArray:
    """Return values (M, D, P, L) with three-point derivatives along all axes that have several knots."""
    numbers = _no_derivatives(values)
    position, period = np.asarray(table.position, dtype=float), float(table.period)
    around = np.concatenate([position[-1:] - period, position, position[:1] + period])
    closed = np.concatenate([values[:, :, -1:], values, values[:, :, :1]], axis=2)
    numbers[0, 0, 1] = np.gradient(closed, around, axis=2)[:, :, 1:-1]
    if np.size(table.center_distance_change) > 1:
        knots = np.asarray(table.center_distance_change, dtype=float)
        numbers[0, 1] = np.gradient(numbers[0, 0], knots, axis=-3)
    if np.size(table.misalignment) > 1:
        numbers[1] = np.gradient(numbers[0], np.asarray(table.misalignment, dtype=float), axis=-4)
    return numbers
