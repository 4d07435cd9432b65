"""Where runs start: static equilibria, motions at rest, and freedoms by modes."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, gear_pair_scene, spring_table, square_wave_table, with_gear, with_mesh
from housed_pair import MODES, NAMES, SEATS, SPEED, housed_pair
from planetary_scenes import planetary_scene, published_set
from scipy.linalg import expm
from scipy.sparse.csgraph import connected_components

from dynamics import Integration, Outputs, RollingContact, TimeLaw, simulate, simulate_to_file
from dynamics.arrays.modal_freedoms import MIN, TOGETHER, modal_freedoms_of
from dynamics.arrays.sparse_rows import joined_by_chains, sparse_matrices
from dynamics.assembly import bearing_rest
from dynamics.assembly.assemble import assemble
from dynamics.errors import SolveError
from dynamics.integrators import integrate, static_equilibrium
from dynamics.linearize import linearize
from dynamics.loads import AppliedForce, Orders
from dynamics.motion.observation import local_state, observe
from dynamics.types import RunStatus, StaticStatus

# Static equilibrium: deflections by hand, and what happens without one.


FORCE = 100.0 / BASE_RADIUS


def test_springs_in_series():
    system = assemble(gear_pair_scene(spring_table(4e8)))
    found = static_equilibrium(system)
    assert found.status is StaticStatus.CONVERGED
    assert found.mesh_force[0] == pytest.approx(FORCE, rel=1e-9)
    assert system.arrays.direction[0] @ found.displacement == pytest.approx(FORCE / 4e8, rel=1e-9)
    offset = np.hypot(*found.displacement[:2])
    assert offset == pytest.approx(FORCE / 2e8, rel=1e-9)
    turned = found.displacement[system.freedoms.name.index("output.rotation")] * BASE_RADIUS
    assert turned == pytest.approx(FORCE * (1 / 4e8 + 2 / 2e8), rel=1e-9)  # mesh and both shafts' bushings


def test_a_wrong_nominal_force_only_costs_iterations():
    scene = with_mesh(gear_pair_scene(square_wave_table()), nominal_force=9000.0)
    found = static_equilibrium(assemble(scene))
    assert found.status is StaticStatus.CONVERGED
    assert found.iterations > 1
    assert found.mesh_force[0] == pytest.approx(FORCE, rel=1e-8)


def test_a_mesh_that_softens_is_not_thrown_out_of_contact():
    """From far above the load, a full Newton step on the soft branch lands beyond lift-off."""
    level, deflection, stiffness = [0.0, 1e3, 1e4], [0.0, 1e-6, 1e-4], [1e9, 1e8, 9e7]
    fields = {
        "deflection": deflection,
        "stiffness": stiffness,
        "deflection_slope": 0.0,
        "stiffness_slope": 0.0,
    }
    shaped = {name: np.broadcast_to(value, (1, 1, 1, 3)).copy() for name, value in fields.items()}
    table = replace(spring_table(1e8), position=np.zeros(1), level=np.array(level), **shaped)
    scene = with_mesh(gear_pair_scene(table, torque=500.0 * BASE_RADIUS), nominal_force=9000.0)
    found = static_equilibrium(assemble(scene))
    assert found.status is StaticStatus.CONVERGED
    assert found.mesh_force[0] == pytest.approx(500.0, rel=1e-8)


def test_axial_and_tilting_shafts_carry_a_helical_mesh():
    helix = 0.3
    scene = gear_pair_scene(square_wave_table())
    scene = with_gear(with_gear(scene, 0, base_helix_angle=helix), 1, base_helix_angle=-helix)
    system = assemble(scene)
    found = static_equilibrium(system)
    push = system.bearing_stiffness @ found.displacement
    on_ground = push.reshape(2, 2, 3).sum(axis=1)
    line = system.lines[0].force
    np.testing.assert_allclose(on_ground[0], -FORCE * line, rtol=1e-7, atol=1e-4)
    np.testing.assert_allclose(on_ground[1], FORCE * line, rtol=1e-7, atol=1e-4)
    # moments about the left end of the input shaft: bearings balance the mesh at the pitch point
    point = system.lines[0].point
    mesh = np.cross(point, -FORCE * line)
    right = np.cross([0.0, 0.0, 0.2], -push[1])
    left = np.zeros(3)
    np.testing.assert_allclose((mesh + right + left)[:2], 0.0, atol=1e-4)


def test_no_load_rests_at_lift_off():
    found = static_equilibrium(assemble(gear_pair_scene(spring_table(4e8, 1e-6), torque=0.0)))
    assert found.status is StaticStatus.CONVERGED
    assert found.mesh_force[0] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.law
@pytest.mark.parametrize("planets", [3, 4, 5])
def test_a_planet_set_back_too_far_leaves_its_load_to_the_others(planets):
    """Sun, ring and carrier held across the axis: the others share alike, and it touches nothing."""
    held = {"sun_stiffness": None, "ring_stiffness": None, "carrier_stiffness": None}
    errors = ((0.0, 200e-6), *[(0.0, 0.0)] * (planets - 1))
    gears = published_set(planets, pin_errors=errors, **held)
    found = static_equilibrium(assemble(planetary_scene(gears, sun_torque=200.0)))
    assert found.status is StaticStatus.CONVERGED
    force = 200.0 / gears.base_radius[0]
    np.testing.assert_array_equal(found.mesh_force[:2], 0.0)
    np.testing.assert_allclose(found.mesh_force[2:], force / (planets - 1), rtol=1e-9)


def test_inertia_alone_loads_an_unloaded_pair():
    """Speeding up without a load; the table has no stiffness at lift-off."""
    speed = TimeLaw.ramp(0.0, 100.0, 1.0)
    found = static_equilibrium(assemble(gear_pair_scene(square_wave_table(), torque=0.0, speed=speed)))
    assert found.status is StaticStatus.CONVERGED
    assert found.mesh_force[0] == pytest.approx(1.1344291072112745e-3 * 100.0 / BASE_RADIUS, rel=1e-8)


@pytest.mark.law
def test_a_load_that_pulls_the_flanks_apart_has_no_equilibrium():
    scene = gear_pair_scene(spring_table(4e8), duration=0.01)
    pull = replace(scene.loads[0], torque=TimeLaw.constant(-20.0))
    scene = with_mesh(replace(scene, loads=(pull,)), nominal_force=FORCE)
    assert static_equilibrium(assemble(scene)).status is StaticStatus.UNBALANCED
    with pytest.raises(SolveError, match="no static equilibrium") as caught:
        simulate(scene)
    assert caught.value.partial.status is RunStatus.NO_EQUILIBRIUM
    assert caught.value.partial.time.size == 1


# A motion that dies away comes to rest: numbers that underflow would cost a hundred times as much.


@pytest.mark.parametrize("method", ["explicit", "implicit"])
def test_what_dies_away_is_at_rest_before_it_underflows(method):
    """Along the axis nothing pushes a spur gear: what is there at the start falls by its damping alone."""
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.constant(50.0), duration=2.0)
    scene = replace(scene, effects={**scene.effects, "axial": "on"})
    system = assemble(scene)
    along = system.freedoms.name.index("input.z")
    start = static_equilibrium(system)
    moved = start.displacement.copy()
    moved[along] = 1e-9
    run = integrate(system, replace(start, displacement=moved), Integration(method=method))
    sizes = np.abs(run.q[:, along])
    assert sizes[0] > 1e-10
    assert not np.any((sizes > 0.0) & (sizes < 1e-200))
    assert np.all(run.q[-10:, along] == 0.0) and np.all(run.v[-10:, along] == 0.0)


# Modal freedoms: time steps eliminate them and the linear bearings on them, and lose nothing by it.


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


def test_bodies_on_linear_bearings_alone_rest_without_damped_steps(monkeypatch):
    """The first step solves a linear balance, the next ones take what its rounding leaves."""
    monkeypatch.setattr(bearing_rest, "ITERATIONS", 5)
    arrays = assemble(housed_pair()).arrays
    force = FORCE * arrays.direction[0]
    rest = bearing_rest.rest_on_bearings(arrays, arrays.stiffness, force)
    assert rest.settled
    assert np.max(np.abs(rest.displacement * arrays.scale)) > 1e-5


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
    n = 2 * MIN
    mass, damping, stiffness, direction = np.eye(n), np.zeros((n, n)), np.eye(n), np.ones((3, n))
    others = np.zeros((2, n))
    assert modal_freedoms_of(mass, damping, stiffness, direction, others).first == 0
    if bound == "coupled":
        damping[3, 7] = damping[7, 3] = 1.0
    else:
        others[0 if bound == "loaded" else 1, 7] = 1.0
    modal = modal_freedoms_of(mass, damping, stiffness, direction, others)
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


def test_samples_without_amplitudes_have_what_these_carry_and_all_of_them_where_asked():
    scene = replace(housed_pair(), meshes=gear_pair_scene(square_wave_table()).meshes, duration=0.01)
    modal_samples, runs = np.array([30, 80]), []
    for outputs in (POINTS, replace(POINTS, displacements=False)):
        system = assemble(replace(scene, outputs=outputs))
        start = static_equilibrium(system)
        runs.append(integrate(system, start, system.scene.integration, modal_samples=modal_samples))
    (full, lean), modal = (run.states for run in runs), system.arrays.sparse.modal
    assert lean.q.shape[1] == modal.first < full.q.shape[1] == system.arrays.mass.shape[0]
    np.testing.assert_array_equal(lean.q, full.q[:, : modal.first])
    amplitudes = np.stack(
        [full.q[modal_samples, modal.first :], full.v[modal_samples, modal.first :]], axis=1
    )
    for run in runs:
        np.testing.assert_array_equal(run.modal_states, amplitudes)
    for states in (full, lean):
        seen = observe(system.arrays, runs[0].time, states.q, states.v, states.quanta, states.carried)
        np.testing.assert_array_equal(seen.force[0], full.filtered[:, 0])


def test_freedoms_that_a_chain_joins_are_those_of_a_graph():
    random = np.random.default_rng(4)
    for size, entries in ((1, 0), (2, 1), (40, 20), (40, 40), (40, 200)):
        joined = np.zeros((size, size), dtype=bool)
        joined[random.integers(0, size, entries), random.integers(0, size, entries)] = True
        part = connected_components(joined)[1]
        np.testing.assert_array_equal(joined_by_chains(joined), part[:, None] == part)
    assert joined_by_chains(np.eye(100, k=1, dtype=bool)).all()  # one chain through all
