"""Housings with mass: statics of their matrices, modes and response in closed form, forces, any bearing."""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table, square_wave_table, with_bushings
from housed_scenes import BLOCK, GROUND, MASS, NAMES, OFF, ON, STIFFNESS, block, housed, matrices, pair, rows

from dynamics import Housing, Integration, Outputs, RollingContact, forced_response, simulate, steady_states
from dynamics.assembly.assemble import assemble
from dynamics.bearings import BallBearing, RollingBearing
from dynamics.bearings.row_law import row_law
from dynamics.deflection import LoadCase, deflect
from dynamics.errors import InputError
from dynamics.integrators import static_equilibrium
from dynamics.linearize import linearize, natural_modes, whirl_modes
from dynamics.loads import AppliedForce, Orders
from dynamics.motion.observation import local_state

BALLS = BallBearing(count=7, diameter=11.5e-3, pitch_diameter=43.5e-3, clearance=1e-5)


FULL = {
    "stiffness": rows(
        [
            [3e8, 2e7, 1e7, 1e5, 4e6],
            [2e7, 2e8, -2e7, -3e6, 2e5],
            [1e7, -2e7, 1e8, 3e5, -1e5],
            [1e5, -3e6, 3e5, 2e5, 1e4],
            [4e6, 2e5, -1e5, 1e4, 3e5],
        ]
    ),
    "preload": (100.0, -50.0, 20.0, 1.0, -2.0),
}


def freedom(system, name):
    return system.freedoms.name.index(name)


def bearing_forces(system, found):
    rest = 0.0 * found.displacement
    local = local_state(system.arrays, 0.0, found.displacement, rest).force
    return system.bearing_force(local[:, None], found.displacement[None], rest[None])[..., 0]


@pytest.mark.parametrize(
    ("per", "modal", "bearing"),
    [(3, 0, {}), (5, 0, {}), (6, 0, {}), (5, 7, {}), (5, 0, FULL)],
    ids=["three rows", "five", "six", "modal", "full bearings"],
)
def test_it_rests_as_the_housing_without_mass(per, modal, bearing):
    scene = housed(with_bushings(pair(), **bearing), per, modal)
    with_mass, without = assemble(scene), assemble(replace(scene, effects=OFF))
    found, expected = static_equilibrium(with_mass), static_equilibrium(without)
    assert found.status.usable and expected.status.usable
    n = expected.displacement.size
    assert with_mass.freedoms.name[:n] == without.freedoms.name
    assert len(with_mass.freedoms.name) == n + 4 * per + modal
    size = np.max(np.abs(expected.displacement * without.arrays.scale))
    np.testing.assert_allclose(
        found.displacement[:n] * without.arrays.scale,
        expected.displacement * without.arrays.scale,
        rtol=0.0,
        atol=1e-9 * size,
    )
    forces = bearing_forces(without, expected)
    rows_of = slice(None) if bearing else slice(3)  # condensed bearings state moments, zero on plain ones
    np.testing.assert_allclose(
        bearing_forces(with_mass, found)[:, rows_of],
        forces[:, rows_of],
        rtol=0.0,
        atol=1e-9 * np.max(np.abs(forces)),
    )


def test_its_misalignment_is_that_of_the_housing_without_mass_by_cause():
    """Bearings that are linear, but by a law: a line through zero."""
    scene = with_bushings(housed(pair(effects={"lateral": "on", "tilt": "on"})), radial_stiffness=0.0)
    laws = tuple(RollingContact(name, 1e8, 1.0) for name in NAMES)
    curved = replace(scene, rolling_contacts=laws)
    linear = with_bushings(scene, radial_stiffness=1e8)
    found, expected = (deflect(part, (LoadCase("load"),), 2).cases[0].meshes[0] for part in (curved, linear))
    assert abs(expected.misalignment) > 1e-6
    np.testing.assert_allclose(
        found.causes, expected.causes, rtol=0.0, atol=1e-9 * abs(expected.misalignment)
    )
    assert abs(expected.causes[3]) > 0.05 * abs(expected.misalignment)


def test_a_disc_on_a_block_has_the_modes_of_two_masses():
    system = assemble(block())
    kinetic, spring = np.diag([MASS, BLOCK]), STIFFNESS * np.array([[1.0, -1.0], [-1.0, 1.0]])
    spring[1, 1] += GROUND
    square = np.sort(np.linalg.eigvals(np.linalg.solve(kinetic, spring)).real)
    found = natural_modes(system)
    across = [freedom(system, f"disc.{kind}") for kind in "xy"]
    own = np.flatnonzero(np.max(np.abs(found.shape[:, across]), axis=1) > 1e-3)
    np.testing.assert_allclose(
        found.frequency[own], np.repeat(np.sqrt(square), 2) / (2.0 * math.pi), rtol=1e-9
    )
    assert np.any(np.abs(whirl_modes(system).frequency - found.frequency[own[0]]) < 1.0)


def test_the_dynamic_stiffness_is_that_of_the_matrices_at_any_frequency():
    """Amplitudes eliminated: bearings in series with K + i w C - w^2 M of the housing."""
    scene = housed(pair(), 5, 7)
    system, bare = assemble(scene), assemble(replace(scene, housings=()))
    stiffness, damping, mass = matrices(5, 7)
    about, other = linearize(system), linearize(bare)
    n = other.mass.shape[0]
    seats = np.concatenate([bare.freedoms.keep(motion) for motion in bare.supports.motion])
    springs, dampers = bare.supports.stiffness.ravel(), bare.supports.damping.ravel()
    place = [5 * seat + axis for seat in range(4) for axis in range(3)]
    for omega in (30.0, 3000.0, 10000.0):
        whole = about.stiffness + 1j * omega * about.damping - omega**2 * about.mass
        found = whole[:n, :n] - whole[:n, n:] @ np.linalg.solve(whole[n:, n:], whole[n:, :n])
        own = np.diag(springs + 1j * omega * dampers)
        ground = stiffness + 1j * omega * damping - omega**2 * mass
        compliance = np.linalg.inv(ground)[np.ix_(place, place)]
        series = np.linalg.inv(np.linalg.inv(own) + compliance)
        rest = other.stiffness + 1j * omega * other.damping - omega**2 * other.mass
        expected = rest + seats.T @ (series - own) @ seats
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.max(np.abs(expected)))


def test_a_run_has_the_response_of_two_masses_and_balances_seat_and_feet():
    """A force once a turn on the disc; the block as a tuned one."""
    omega, size = 700.0, 50.0
    push = AppliedForce("push", "disc", 0.1, (size, 0.0, 0.0), course=Orders("disc", (1.0,), (1.0,), (0.0,)))
    outputs = Outputs(displacements=True, accelerations=True, sample_rate=5000.0, anti_alias=False)
    scene = block(
        ratio=0.1,
        force=(push,),
        speed=omega,
        duration=0.4,
        outputs=outputs,
        integration=Integration(tolerance=1e-11),
    )
    result = simulate(scene)
    assert result.energy.relative < 1e-4
    at = result.freedom.index("disc.x")
    modes = [result.freedom.index(f"case.mode_{number}") for number in (1, 2, 3)]
    late = result.time > 0.3
    turning = np.stack([np.cos(omega * result.time[late]), np.sin(omega * result.time[late])])
    fit = np.linalg.lstsq(turning.T, result.displacement[at][late], rcond=None)[0]
    damping = 2.0 * 0.05 * math.sqrt(STIFFNESS * MASS)
    own, loss = STIFFNESS + 1j * omega * damping, 2.0 * 0.1 * math.sqrt(GROUND * BLOCK)
    ground = GROUND + 1j * omega * loss - omega**2 * BLOCK
    expected = size / (1.0 / (1.0 / own + 1.0 / ground) - omega**2 * MASS)
    assert fit[0] - 1j * fit[1] == pytest.approx(expected, rel=1e-4)
    seat = result.bearing.index("seat")
    shape = assemble(scene).rotors.housings[0].shape[0, :3]
    inertia = BLOCK * shape @ result.acceleration[modes]
    feet = GROUND * shape @ result.displacement[modes] + loss * shape @ result.velocity[modes]
    force = result.bearing_force[seat]
    assert np.max(np.abs(force[0])) > 10.0
    moved = result.bearing_acceleration[seat, 0]  # of the shaft, not against its seat
    np.testing.assert_allclose(moved, result.acceleration[at], rtol=0.0, atol=1e-9 * np.max(np.abs(moved)))
    np.testing.assert_allclose(force, inertia + feet, rtol=0.0, atol=1e-8 * np.max(np.abs(force)))


@pytest.mark.law
def test_runs_and_steady_states_agree_with_linear_theory_on_a_housing():
    """A weak ripple: the mesh stays a spring."""
    table = spring_table(4e8, amplitude=1e-8)
    scene = housed(replace(pair(), meshes=gear_pair_scene(table).meshes))
    system = assemble(replace(scene, integration=Integration(tolerance=1e-12)))
    speeds = np.array([90.0, 200.0])
    linear = forced_response(system, speeds, orders=1)
    found = steady_states(system, speeds, branch=False)
    rising = found.curve == 0
    expected = 2.0 * np.abs(linear.dynamic_transmission_error[0, :, 0])
    np.testing.assert_allclose(found.peak_to_peak_error[rising, 0], expected, rtol=2e-3)


def test_a_disc_with_clearance_rests_on_bearing_and_block_in_series():
    k, clearance, exponent, force = 5e8, 20e-6, 10.0 / 9.0, 400.0
    contact = RollingContact("seat", k, exponent, clearance)
    scene = block((contact,), radial=0.0, force=(AppliedForce("push", "disc", 0.1, (force, 0.0, 0.0)),))
    system = assemble(scene)
    found = static_equilibrium(system)
    assert found.status.usable
    series = clearance + (force / k) ** (1.0 / exponent) + force / GROUND
    assert found.displacement[freedom(system, "disc.x")] == pytest.approx(series, rel=1e-8)
    case = deflect(scene, (LoadCase("load"),), 1).cases[0]
    seat = next(load for load in case.bearings if load.name == "seat")
    assert seat.seat[0] == pytest.approx(force / GROUND, rel=1e-8)
    assert seat.clearance[0] == pytest.approx(clearance, rel=1e-8)
    assert seat.force[0] == pytest.approx(force, rel=1e-8)


def test_a_rolling_bearing_by_geometry_rests_on_a_block():
    force = np.array([300.0, -200.0, 0.0, 0.0, 0.0])
    push = AppliedForce("push", "disc", 0.1, (300.0, -200.0, 0.0))
    bearing = RollingBearing("seat", "disc", BALLS, 0.1)
    scene = block(bearings=(bearing,), force=(push,))
    system = assemble(replace(scene, effects=ON | {"tilt": "off", "axial": "off"}))
    found = static_equilibrium(system)
    assert found.status.usable
    expected = row_law(bearing).loaded.displacement(tuple(force))[:2] + force[:2] / GROUND
    at = [freedom(system, f"disc.{kind}") for kind in "xy"]
    np.testing.assert_allclose(found.displacement[at], expected, rtol=0.0, atol=1e-6 * abs(expected[0]))


def test_a_run_on_bearings_with_clearance_in_a_housing_closes_its_balance():
    scene = with_bushings(housed(pair()), radial_stiffness=0.0)
    laws = tuple(RollingContact(name, 1e11, 1.5, 10e-6) for name in NAMES)
    scene = replace(scene, rolling_contacts=laws, meshes=gear_pair_scene(square_wave_table()).meshes)
    result = simulate(replace(scene, duration=0.01, integration=Integration(tolerance=1e-11)))
    assert result.energy.relative < 1e-3
    off = assemble(replace(scene, effects=ON | {"bearing_clearance": "off"}))
    tangents = natural_modes(assemble(scene)).frequency
    np.testing.assert_allclose(natural_modes(off).frequency, tangents, rtol=1e-6, atol=1e-3)


def test_a_run_on_full_bearing_matrices_in_a_housing_closes_its_balance():
    scene = replace(housed(with_bushings(pair(), **FULL)), meshes=gear_pair_scene(square_wave_table()).meshes)
    result = simulate(replace(scene, duration=0.01, integration=Integration(tolerance=1e-11)))
    assert result.energy.relative < 1e-4
    assert np.max(np.abs(result.bearing_moment[0, :2])) > 1.0


def test_modes_with_modal_damping_are_coupled_by_their_bearings_alone():
    """These are force elements: what time steps invert has a block per shaft, and a mode each."""
    system = assemble(housed(pair(), 5, 7, damping=None))
    modes = [name.startswith("case.") for name in system.freedoms.name]
    assert sum(modes) == 27
    coupling = system.arrays.sparse.coupling
    entries = np.diff(coupling.first)[modes]
    np.testing.assert_array_equal(entries, 1)


def test_what_is_no_housing_with_mass_is_named():
    stiffness, _, mass = matrices(5)
    at = tuple((0.0, 0.0, 0.0) for _ in NAMES)
    cases = {
        "mass": {"mass": rows(np.diag([1.0] * 19 + [0.0]))},
        "stiffness": {"stiffness": rows(np.diag([1.0] * 19 + [0.0]))},
        "modal_coordinates": {"mass": None, "modal_coordinates": 3},
        "seat_positions": {"seat_positions": at[:2]},
    }
    for field, changes in cases.items():
        with pytest.raises(InputError) as caught:
            Housing("case", NAMES, **{"stiffness": rows(stiffness), "mass": rows(mass)} | changes)
        assert caught.value.field == field
    with pytest.raises(InputError) as caught:
        housed(pair(), seat_positions=at)
    assert caught.value.field == "housings[0].seat_positions[1]"
    assert "-0.2 m" in str(caught.value)
