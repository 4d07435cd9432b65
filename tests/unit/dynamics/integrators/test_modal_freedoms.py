"""Modal freedoms: time steps eliminate them and the linear bearings on them, and lose nothing by it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, square_wave_table
from housed_pair import MODES, NAMES, SEATS, SPEED, housed_pair
from scipy.linalg import expm

from dynamics.arrays.sparse_rows import LEAST, TOGETHER, modal_freedoms, sparse_matrices
from dynamics.assembly.assemble import assemble
from dynamics.forces import RollingContact
from dynamics.integrators import integrate, static_equilibrium
from dynamics.linearize import linearize
from dynamics.loads import AppliedForce
from dynamics.loads.load_course import Orders
from dynamics.motion.observation import local_state
from dynamics.scene import Integration
from dynamics.settings import Outputs
from dynamics.simulation import simulate, simulate_to_file

PUSH = 50.0
POINTS = Outputs(sample_rate=20e3, anti_alias=False, displacements=True)


def pushed(scene):
    """The scene under a force on the input shaft, once a turn."""
    course = Orders("input", (1.0,), (1.0,), (0.0,))
    return replace(scene, forces=(AppliedForce("push", "input", 0.1, (PUSH, 0.0, 0.0), course=course),))


def exact(system, start, times):
    """Solve M q'' + C q' + K q = p cos w t from rest in `start` by the matrix exponential; q (T, n)."""
    linear, arrays = linearize(system), system.arrays
    rest, n = np.zeros(start.size), start.size
    quarter = 0.5 * np.pi / SPEED
    force = [local_state(arrays, at, start, rest).force @ arrays.direction for at in (0.0, quarter)]
    accelerated = np.linalg.solve(linear.mass, np.column_stack([linear.stiffness, linear.damping]))
    rate = np.zeros((2 * n + 2, 2 * n + 2))
    rate[:n, n : 2 * n], rate[n : 2 * n, : 2 * n] = np.eye(n), -accelerated
    rate[n : 2 * n, 2 * n] = np.linalg.solve(linear.mass, force[1] - force[0])
    rate[2 * n :, 2 * n :] = SPEED * np.array([[0.0, -1.0], [1.0, 0.0]])
    unit, state, states = expm(rate * (times[1] - times[0])), np.zeros(2 * n + 2), []
    state[2 * n] = 1.0
    for _ in times:
        states.append(start + state[:n])
        state = unit @ state
    return np.array(states)


def test_amplitudes_of_a_housing_are_modal_and_rotors_are_not():
    system = assemble(housed_pair())
    modal, names = system.arrays.sparse.modal, system.freedoms.name
    assert all(name.startswith("case.") for name in names[modal.first :])
    assert not any(name.startswith("case.") for name in names[: modal.first])
    assert len(names) - modal.first == SEATS + MODES
    dense = np.zeros_like(system.arrays.direction[:, modal.first :])
    np.add.at(dense, modal.row, modal.shape)
    np.testing.assert_array_equal(dense, system.arrays.direction[:, modal.first :])


@pytest.mark.parametrize("bound", ["coupled", "moves a position", "loaded"])
def test_a_freedom_that_more_than_elements_bind_is_not_modal(bound):
    n = 2 * LEAST
    mass, damping, stiffness, direction = np.eye(n), np.zeros((n, n)), np.eye(n), np.ones((3, n))
    others = np.zeros((2, n))
    assert modal_freedoms(mass, damping, stiffness, direction, others).first == 0
    if bound == "coupled":
        damping[3, 7] = damping[7, 3] = 1.0
    else:
        others[0 if bound == "loaded" else 1, 7] = 1.0
    modal = modal_freedoms(mass, damping, stiffness, direction, others)
    assert modal.first == 8
    assert modal.row.size % TOGETHER == 0
    assert sparse_matrices(mass, damping, stiffness, direction, others).bodies.column.max() == 7


def test_a_linear_run_is_the_matrix_exponential():
    """Rotors, mesh, bearings and 32 modes under a harmonic force that sets in at t = 0."""
    scene = pushed(housed_pair(duration=0.02, outputs=POINTS))
    system = assemble(replace(scene, integration=Integration(method="implicit", tolerance=1e-12)))
    start = static_equilibrium(system)
    run = integrate(system, start, system.scene.integration)
    expected = exact(system, start.displacement, run.time)
    scale = system.arrays.scale
    moved = np.max(np.abs(expected - start.displacement) * scale)
    assert moved > 1e-7
    np.testing.assert_allclose(run.q * scale, expected * scale, rtol=0.0, atol=1e-5 * moved)


@pytest.mark.parametrize("clearance", [None, 5e-6], ids=["linear bearings", "clearance beside linear rows"])
def test_implicit_steps_with_the_elimination_agree_with_explicit_ones_without(clearance):
    scene = housed_pair({} if clearance is None else {"radial_stiffness": 0.0})
    laws = () if clearance is None else tuple(RollingContact(name, 1e11, 1.5, clearance) for name in NAMES)
    scene = replace(scene, rolling_contacts=laws, meshes=gear_pair_scene(square_wave_table()).meshes)
    scene = replace(scene, duration=0.005, outputs=POINTS)
    runs = [
        simulate(replace(scene, integration=Integration(method=method, tolerance=1e-12)))
        for method in ("implicit", "explicit")
    ]
    for name in ("dynamic_transmission_error", "bearing_force", "displacement"):
        ours, theirs = (getattr(run, name) for run in runs)
        size = np.max(np.ptp(theirs, axis=-1))
        assert size > 0.0
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-4 * size, err_msg=name)
    assert all(run.energy.relative < 1e-3 for run in runs)


def test_series_are_the_same_whether_amplitudes_are_filtered_or_not(tmp_path):
    """In memory and in a file: no output has the amplitudes, so that the filter may leave them out."""
    scene = replace(housed_pair(), meshes=gear_pair_scene(square_wave_table()).meshes, duration=0.02)
    runs = [
        simulate(replace(scene, outputs=Outputs(sample_rate=10e3, displacements=kept)))
        for kept in (False, True)
    ]
    names = (
        "dynamic_transmission_error",
        "static_transmission_error",
        "mesh_force",
        "bearing_force",
        "speed",
    )
    for name in names:
        np.testing.assert_array_equal(*(getattr(run, name) for run in runs), err_msg=name)
    assert runs[1].displacement.shape[0] == len(assemble(scene).freedoms.name)
    path = tmp_path / "run.nc"
    simulate_to_file(replace(scene, outputs=Outputs(sample_rate=10e3)), path)
    kept = type(runs[0]).from_netcdf(path)
    np.testing.assert_array_equal(kept.bearing_force, runs[0].bearing_force)
