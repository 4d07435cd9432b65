"""Tables of a mesh mean the same in both libraries: axes, forces, and how often they are evaluated."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import spring_table, square_wave_table
from sliced_face import sliced_database

from dynamics.kernels.compiled import compiled
from dynamics.meshes.grid_energy import grid_energy
from dynamics.meshes.grid_lookup import find_cell, grid_force
from dynamics.meshes.grid_tables import GridTables
from dynamics.meshes.mesh_table import MeshTable, check_table
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.table_lookup import table_deflection, table_force
from fe_contact.ste import MeshForce, Metadata, PairGeometry, SteDatabase
from fe_contact.ste.force_table import ForceTable

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


M, A = (-20e-6, -8e-6, 3e-6, 18e-6), (-1e-4, 0.0, 2e-4)


@compiled
def look_up(grid, position, deflection, m, a, found):
    """Write force, its derivatives in d, x, m, a, and the energy with its own in x, m, a: (Q, 9)."""
    for q in range(position.size):
        cell = find_cell(grid, 0, position[q], m[q], a[q])
        force = grid_force(grid, 0, cell, deflection[q], 0)
        energy = grid_energy(grid, 0, cell, deflection[q])
        found[q, 0], found[q, 1], found[q, 2] = force.value, force.d, force.x
        found[q, 3], found[q, 4] = force.m, force.a
        found[q, 5], found[q, 6], found[q, 7], found[q, 8] = energy.value, energy.x, energy.m, energy.a


def at(table, *query):
    found = np.empty((query[0].size, 9))
    look_up(
        GridTables.packed([table]), *(np.ascontiguousarray(values, dtype=float) for values in query), found
    )
    return found


@pytest.fixture(scope="module", params=["both axes", "misalignment", "center distance"])
def table(request):
    m = M if request.param != "center distance" else (5e-6,)
    a = A if request.param != "misalignment" else (1e-4,)
    return sliced_database(m, a, positions=12).force_table()


def queries(count, margin):
    """Random places, `margin` of the axes' length beyond their ends."""
    rng = np.random.default_rng(5)
    m = rng.uniform(M[0] - margin * 38e-6, M[-1] + margin * 38e-6, count)
    a = rng.uniform(A[0] - margin * 3e-4, A[-1] + margin * 3e-4, count)
    return rng.uniform(-3.0, 3.0, count), rng.uniform(-1e-5, 4e-5, count), m, a


@pytest.mark.law
def test_both_evaluate_alike_inside_and_beyond_the_axes(table):
    check_table(table, "table")
    x, d, m, a = queries(3000, 0.2)
    theirs = MeshForce(table).force_at(x, d, m, a)
    ours = at(table, x, d, m, a)
    top = table.level[-1]
    assert np.mean(ours[:, 0] == 0.0) > 0.05  # lift-off
    assert np.mean(ours[:, 0] > top) > 0.05  # above the table
    slack = 1e-14 * np.abs(theirs.position_slope).max()  # positions wrap with different rounding
    np.testing.assert_allclose(ours[:, 0], theirs.force, rtol=1e-10, atol=1e-10 * top + slack)
    np.testing.assert_allclose(ours[:, 1], theirs.stiffness, rtol=1e-8, atol=1e-8 * theirs.stiffness.max())
    np.testing.assert_allclose(
        ours[:, 2], theirs.position_slope, rtol=1e-8, atol=1e-8 * np.abs(theirs.position_slope).max()
    )


@pytest.mark.parametrize("axis", [0, 1, 2, 3])
def test_derivatives_are_those_of_force_and_energy(table, axis):
    """Against central differences: force in d, x, m, a and energy in x, m, a; dV/dd is the force."""
    query = list(queries(400, 0.0))
    step = (1e-6, 1e-12, 1e-11, 1e-9)[axis]
    more, less = list(query), list(query)
    more[axis], less[axis] = query[axis] + step, query[axis] - step
    here, high, low = at(table, *query), at(table, *more), at(table, *less)
    force = here[:, (2, 1, 3, 4)[axis]]
    energy = here[:, (6, 0, 7, 8)[axis]]
    for exact, column in ((force, 0), (energy, 5)):
        difference = (high[:, column] - low[:, column]) / (2.0 * step)
        # a query whose neighbors lie on either side of a knot or of lift-off: second order is lost there
        np.testing.assert_allclose(difference, exact, rtol=1e-4, atol=2e-4 * np.abs(exact).max() + 1e-300)


def test_the_force_is_smooth_across_knots_of_the_axes():
    """C1: derivatives of both sides of a knot of m and a agree."""
    table = sliced_database(M, A, positions=12).force_table()
    x, d, m, a = queries(200, 0.0)
    for axis, knot, step in ((2, M[1], 1e-13), (3, A[1], 1e-12)):
        sides = []
        for sign in (-1.0, 1.0):
            query = [x, d, m, a]
            query[axis] = np.full(x.size, knot + sign * step)
            sides.append(at(table, *query)[:, :5])
        scale = np.abs(sides[0]).max(axis=0)
        np.testing.assert_allclose(sides[0] / scale, sides[1] / scale, rtol=0.0, atol=1e-6)


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
        geometry=PairGeometry((20, 30), (0.04, 0.06), 0.0118, 0.3, 0.1, 0.35, 0.025, 1),
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
