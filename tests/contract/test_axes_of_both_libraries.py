"""A table over misalignment and center distance, two evaluations: fe_contact in numpy, dynamics compiled."""

from __future__ import annotations

import numpy as np
import pytest
from sliced_face import sliced_database

from dynamics.kernels.compiled import compiled
from dynamics.meshes.grid_lookup import find_cell, grid_force
from dynamics.meshes.grid_tables import GridTables
from dynamics.meshes.mesh_table import check_table
from dynamics.meshes.spatial_flank import grid_energy
from fe_contact.ste.mesh_force import MeshForce

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
