"""One table, two evaluations: fe_contact in numpy, dynamics compiled."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "fakes"))

from geared_scenes import spring_table, square_wave_table

from dynamics.meshes.mesh_table import check_table
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.table_lookup import table_deflection, table_force
from fe_contact.ste.force_table import ForceTable
from fe_contact.ste.mesh_force import MeshForce

FIELDS = (
    "position",
    "level",
    "misalignment",
    "center_distance_change",
    "deflection",
    "deflection_slope",
    "stiffness",
    "stiffness_slope",
    "period",
)


def waving_table():
    """Three pitches, each with knots and a height of its own."""
    table = spring_table(4e8, positions=60)
    wave = 1e-6 * np.cos(2 * np.pi * table.position + 0.3)[None, None, :, None]
    slope = -2e-6 / 3 * np.pi * np.sin(2 * np.pi * table.position + 0.3)[None, None, :, None]
    return replace(
        table,
        position=3.0 * table.position**1.1,
        period=3,
        deflection=table.deflection + wave,
        deflection_slope=table.deflection_slope + slope,
    )


@pytest.mark.parametrize(
    "make",
    [square_wave_table, lambda: spring_table(4e8, 1e-6), waving_table],
    ids=["square wave", "spring", "three pitches"],
)
def test_both_evaluate_alike(make):
    table = ForceTable(**{name: getattr(make(), name) for name in FIELDS})
    check_table(table, "table")
    packed = pack_tables([table])
    rng = np.random.default_rng(3)
    position = rng.uniform(-4.0, 7.0, 2000)
    deflection = rng.uniform(-2e-6, 1.3 * table.deflection.max(), 2000)
    theirs = MeshForce(table).force_at(position, deflection, 0.0, 0.0)
    ours = np.array([table_force(packed, 0, x, d, 0)[:2] for x, d in zip(position, deflection, strict=True)])
    np.testing.assert_allclose(ours[:, 0], theirs.force, rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(ours[:, 1], theirs.stiffness, rtol=1e-6, atol=1.0)
    loaded = theirs.force > 1.0
    back = [
        table_deflection(packed, 0, x, f) for x, f in zip(position[loaded], theirs.force[loaded], strict=True)
    ]
    np.testing.assert_allclose(back, deflection[loaded], rtol=1e-9)
