"""Tables on every second position: the Hermite interpolant of the nodes that stay."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import spring_table, square_wave_table

from dynamics.meshes.grid_tables import GridTables
from dynamics.meshes.mesh_table import FIELDS
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.table_lookup import table_force


def each(table, every):
    """The table of every n-th node, written out."""
    kept = {name: getattr(table, name)[:, :, ::every] for name in FIELDS}
    return replace(table, position=table.position[::every], **kept)


def uneven(positions=31):
    """An odd number of uneven nodes, the first not at 0."""
    table = square_wave_table(positions)
    return replace(table, position=0.03 + 0.9 * table.position**1.3)


@pytest.mark.parametrize("every", [2, 4])
def test_decimating_packed_tables_is_packing_decimated_ones(every):
    tables = [uneven(), square_wave_table(64), spring_table(4e8, 1e-6, positions=16)]
    found, expected = pack_tables(tables).decimated(every), pack_tables([each(t, every) for t in tables])
    for name in found._fields:
        if name not in ("row", "energy"):
            np.testing.assert_allclose(getattr(found, name), getattr(expected, name), rtol=1e-12)
    for columns in (slice(0, 4), slice(4, 8)):  # deflections, stiffnesses
        size = np.abs(expected.row[:, columns]).max()
        np.testing.assert_allclose(found.row[:, columns], expected.row[:, columns], atol=1e-14 * size)
    np.testing.assert_allclose(found.energy, expected.energy, atol=1e-14 * expected.energy.max())
    for flank in range(3):
        for x in np.linspace(-1.0, 2.0, 61):
            one, other = (table_force(packed, flank, x, 6e-6, 0)[0] for packed in (found, expected))
            assert one == pytest.approx(other, rel=1e-9, abs=1e-9)


def test_grids_keep_the_same_nodes():
    tables = [uneven(), square_wave_table(64)]
    found, expected = GridTables.packed(tables).decimated(), GridTables.packed([each(t, 2) for t in tables])
    for name in ("shape", "first", "channels"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    per_level = found.number.reshape(-1, int(found.channels[0]) * 2)[:, :4]  # levers have slopes of their own
    np.testing.assert_allclose(per_level, expected.number.reshape(per_level.shape[0], -1)[:, :4], rtol=1e-12)


def test_a_table_of_few_nodes_stays_as_it_is():
    packed = pack_tables([spring_table(4e8, 1e-6, positions=4)])
    np.testing.assert_array_equal(packed.decimated().row, packed.row)
