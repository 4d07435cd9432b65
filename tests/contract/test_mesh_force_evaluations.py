"""One mesh-force table, two evaluations: numpy in fe_contact.ste, compiled in dynamics. They must agree."""

from __future__ import annotations

import numpy as np
import pytest

from dynamics.meshes.mesh_table import MeshTable, check_table
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.table_lookup import table_deflection, table_force
from fe_contact.ste import MeshForce, Metadata, PairFacts, SteDatabase

RNG = np.random.default_rng(23)
POSITION = np.sort(RNG.uniform(0.0, 1.0, 30))
FORCE = np.array([100.0, 700.0, 2000.0, 9000.0])


@pytest.fixture(scope="module")
def database():
    """Springs of which a second one comes in beyond a gap that varies with position; helical."""
    stiffness, gap = (
        3e8 * (1.0 + 0.2 * np.cos(2 * np.pi * POSITION)),
        5e-6 + 4e-6 * np.sin(2 * np.pi * POSITION),
    )
    alone = FORCE / stiffness[:, None]
    two = alone > gap[:, None]
    ste = np.where(two, (FORCE + 2e8 * gap[:, None]) / (stiffness[:, None] + 2e8), alone)
    tangent = np.where(two, stiffness[:, None] + 2e8, stiffness[:, None])
    shape = (POSITION.size, FORCE.size, 1, 1)
    return SteDatabase(
        position=POSITION,
        force=FORCE,
        torque=FORCE * 0.04 * np.cos(0.3),
        misalignment=[0.0],
        center_distance_change=[0.0],
        pair=[0],
        static_transmission_error=ste.reshape(shape),
        tangent_compliance=(1.0 / tangent).reshape(shape),
        no_load_transmission_error=np.zeros((POSITION.size, 1, 1)),
        load_share=np.ones((*shape, 1)),
        face_centroid=np.zeros(shape),
        max_pressure=np.ones(shape),
        pairs_in_contact=(1 + two).reshape(shape),
        status=np.zeros(shape),
        error_estimate=np.zeros(shape),
        residuals=np.zeros((*shape, 4)),
        facts=PairFacts((20, 30), (0.04, 0.06), 0.0118, 0.3, 0.1, 0.35, 0.025, 1),
        metadata=Metadata(),
    )


def test_the_table_is_what_dynamics_asks_for(database):
    table = database.force_table()
    assert isinstance(table, MeshTable)
    check_table(table, "mesh.table")


def test_force_and_stiffness_agree(database):
    """Inside, on knots and levels, below lift-off, above the table, several turns on."""
    table = database.force_table()
    packed = pack_tables([table])
    x = np.concatenate([RNG.uniform(-5.0, 5.0, 2000), np.repeat(POSITION, 20)])
    d = RNG.uniform(-5e-6, 5e-5, x.size)
    d[::7] = MeshForce(table).deflection_at(x[::7], RNG.choice(table.level, x[::7].size), 0.0, 0.0)[0]
    sample = database.force_at(x, d)
    compiled = np.array([table_force(packed, 0, *query, 0)[:2] for query in zip(x, d, strict=True)])
    # positions wrap with different rounding: 1e-15 pitches times the steepest slope
    slack = 1e-13 * np.abs(sample.position_slope).max()
    assert np.all(np.abs(compiled[:, 0] - sample.force) <= 1e-10 * table.level[-1] + slack)
    # on a level either neighbor may answer; their stiffnesses are equal there
    assert np.allclose(compiled[:, 1], sample.stiffness, rtol=1e-6, atol=1e-6 * sample.stiffness.max())


def test_deflections_agree(database):
    packed = pack_tables([database.force_table()])
    x, force = RNG.uniform(-2.0, 2.0, 300), RNG.uniform(0.0, 12000.0, 300)
    transverse = force * np.cos(0.3)
    compiled = [table_deflection(packed, 0, *query) for query in zip(x, transverse, strict=True)]
    assert np.allclose(compiled, database.ste(x, force), rtol=1e-10, atol=1e-17)
