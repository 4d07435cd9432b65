"""The table of nominal teeth by the table of gears as made: the mean over all base pitches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.identity_cache import identity_cached
from dynamics.meshes.mesh_table import DERIVATIVES, FIELDS, LEVERS, MeshTable
from dynamics.meshes.technique import PlainTable
from dynamics.types import FloatArray

ALIKE = 1e-9
"""Base pitches within which knots of all pitches are at the same place."""


@dataclass(frozen=True)
class NominalTable(PlainTable):
    """A table of one base pitch, and the table of the gears `as_made` whose mean it is."""

    as_made: MeshTable | None = None


@identity_cached
def nominal_table(table: MeshTable) -> MeshTable:
    """Return the mean of `table` over its base pitches; `table` if it has one or its knots differ."""
    position = np.asarray(table.position, dtype=float)
    if table.period == 1 or position.size % table.period:
        return table
    pitches = position.reshape(table.period, -1) - np.arange(table.period)[:, None]
    if np.max(np.ptp(pitches, axis=0)) > ALIKE:
        return table

    def mean(name: str) -> FloatArray:
        values = np.asarray(getattr(table, name), dtype=float)
        *axes, _, levels = values.shape
        return np.asarray(values.reshape(*axes, table.period, -1, levels).mean(axis=-3))

    present = [name for name in (*LEVERS, *DERIVATIVES) if getattr(table, name, None) is not None]
    return NominalTable(
        position=pitches[0],
        level=table.level,
        misalignment=table.misalignment,
        center_distance_change=table.center_distance_change,
        period=1,
        as_made=table,
        **{name: mean(name) for name in (*FIELDS, *present)},
    )


def table_as_made(table: MeshTable) -> MeshTable:
    """Return the table of which `table` is the mean, or itself."""
    made = table.as_made if isinstance(table, NominalTable) else None
    return table if made is None else made
