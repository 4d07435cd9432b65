"""Rotors: geared, unbalanced, and scenes of textbooks."""

import math
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from repository import EXAMPLES

from dynamics.assembly.assemble import System, assemble
from dynamics.bearings import Bushing
from dynamics.integrators import static_equilibrium
from dynamics.joints import FreeRotation, ImposedRotation
from dynamics.linearize import forced_response, natural_modes
from dynamics.loads import LoadTorque, TimeLaw, Unbalance
from dynamics.motion.observation import observe
from dynamics.periodic.period_map import periodic_problem
from dynamics.periodic.shooting import find_orbit
from dynamics.periodic.steady_states import motion
from dynamics.scene import Integration, Outputs, Scene
from dynamics.shafts import Inertia, Shaft
from dynamics.simulation import simulate
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.subjects import scene_of

# A geared rotor with unbalances against an independent rotordynamics code. The turbo-alternator of Rao,
# Shiau and Chang (1998). The two rotors are those of ross-rotordynamics 2.3.0: Timoshenko elements of 60 mm
# at most, discs, bearings and gyroscopic matrices at both speeds, the turbine turning backwards. The mesh
# and the drive's spring were added to its matrices as k g g^T, and the response to each unbalance solved
# for.


EXAMPLE = Path(__file__).parents[3] / "examples" / "geared_rotor_scene.toml"
TEETH = (328, 23)
SPEEDS = (15.0, 60.0, 157.0)
BY_ROSS = {
    # unbalance, rad/s of the generator: forces on the ground in x and y at the four bearings, mesh force, N
    ("generator", 15.0): (
        2.214688e00 - 1.405647e-05j,
        1.251400e-05 - 2.214368e00j,
        4.321152e-02 + 2.437921e-04j,
        -2.505522e-04 - 4.261467e-02j,
        1.041541e-04 - 2.452503e-04j,
        2.502487e-04 - 5.892564e-04j,
        -6.022473e-06 + 1.414932e-05j,
        -1.496091e-05 + 3.525062e-05j,
        2.567346e-04 - 6.045062e-04j,
    ),
    ("generator", 60.0): (
        3.710406e01 - 1.129870e-04j,
        -2.334533e-03 - 3.698995e01j,
        1.538378e00 - 1.362884e-02j,
        1.293049e-02 - 1.518521e00j,
        -4.743686e-03 + 1.242222e-02j,
        -1.086070e-02 + 2.531556e-02j,
        1.466189e-03 - 2.185411e-03j,
        3.469431e-03 - 8.408996e-03j,
        -1.375267e-02 + 3.231978e-02j,
    ),
    ("generator", 157.0): (
        2.321762e02 - 3.009585e00j,
        6.754715e-01 - 2.391200e02j,
        -3.760513e01 - 2.602877e01j,
        2.944590e00 - 2.688862e01j,
        -3.180495e-01 + 2.900730e01j,
        -1.490727e00 + 5.101538e01j,
        -3.935169e-01 - 3.687072e00j,
        -4.207386e-02 + 3.397102e00j,
        -1.615235e00 + 4.438675e01j,
    ),
    ("turbine", 15.0): (
        -6.576631e-01 + 4.170931e-01j,
        -1.776225e00 + 8.914303e-01j,
        -8.061773e00 + 4.374535e00j,
        -1.888821e01 + 9.851664e00j,
        -1.126681e01 + 4.270628e00j,
        1.292350e01 - 7.677743e00j,
        2.067995e01 - 6.743220e00j,
        1.075727e00 + 4.729334e00j,
        1.095597e01 - 5.730491e00j,
    ),
    ("turbine", 60.0): (
        1.744586e01 + 1.093710e01j,
        -7.445376e00 + 2.890291e01j,
        -1.999980e01 - 2.106593e00j,
        7.586008e00 - 4.837545e00j,
        -4.233734e-01 - 2.769077e01j,
        2.549584e01 - 6.608301e01j,
        -2.364979e01 - 5.675084e01j,
        -9.060132e00 + 3.546041e02j,
        -9.971560e-01 + 1.389836e02j,
    ),
    ("turbine", 157.0): (
        -6.461591e-02 - 2.341215e00j,
        -1.006573e00 - 6.083854e00j,
        1.540544e00 + 9.618823e00j,
        3.676178e00 + 2.541695e01j,
        5.480201e00 - 8.708732e00j,
        -3.440267e00 - 8.321569e01j,
        -2.260824e01 - 2.981061e01j,
        2.831407e01 - 2.327800e02j,
        1.052303e02 + 5.760507e02j,
    ),
}


@pytest.fixture(scope="module")
def response():
    """Return the response up to the first order of the mesh, in which both shafts' orders lie."""
    return forced_response(assemble(dynamic_scene(scene_of(EXAMPLE)[0], {})), SPEEDS, orders=1)


@pytest.mark.drawn
@pytest.mark.parametrize(("unbalance", "speed"), BY_ROSS)
def test_bearing_and_mesh_forces_are_those_of_ross(response, unbalance, speed):
    """Complex amplitudes within 0.1 %, each of them; the mesh carries order 1 of either shaft."""
    assert response.order == pytest.approx([1.0 / TEETH[0], 1.0 / TEETH[1]])
    order, at = ("generator", "turbine").index(unbalance), SPEEDS.index(speed)
    forces = response.bearing_force[:, :2, at, order].ravel()
    found = np.array([*forces, response.mesh_force[0, at, order]])
    assert found == pytest.approx(np.array(BY_ROSS[unbalance, speed]), rel=1e-3)


# Jeffcott's rotor: closed forms of response, sag and weight, in linear response, steady states and runs.


MASS, POLAR, STIFFNESS, RATIO = 10.0, 0.05, 2e6, 0.02
DAMPING = 2.0 * RATIO * math.sqrt(STIFFNESS * MASS)
CRITICAL = math.sqrt(STIFFNESS / MASS)
UNBALANCE, ANGLE = 1e-3, 0.3
BEARINGS = tuple(
    Bushing(name, "rotor", at, 0.5 * STIFFNESS, damping_ratio=RATIO) for name, at in (("a", 0.0), ("b", 0.4))
)


def rotor(speed: float = 1.5 * CRITICAL, duration: float = 0.1) -> Scene:
    """Return the rotor in the middle of its bearings, its speed imposed."""
    return Scene(
        shafts=(Shaft("rotor", 0.4, (0.0, 0.0, 0.0), Inertia(MASS, POLAR, 0.4)),),
        gears=(),
        meshes=(),
        drives=(ImposedRotation("motor", "rotor", TimeLaw.constant(speed)),),
        bushings=BEARINGS,
        unbalances=(Unbalance("rotor", "rotor", 0.2, UNBALANCE, ANGLE),),
        duration=duration,
        outputs=Outputs(displacements=True),
    )


def whirl(speed: np.ndarray) -> np.ndarray:
    """Return x + i y over exp(i w t) of the center of the shaft."""
    force = UNBALANCE * speed**2 * np.exp(1j * ANGLE)
    return np.asarray(force / (STIFFNESS - MASS * speed**2 + 1j * DAMPING * speed))


def test_the_response_has_amplitude_and_phase_through_the_critical_speed():
    speed = np.linspace(0.2, 2.0, 19) * CRITICAL
    response = forced_response(assemble(rotor()), speed, orders=3)
    x, y = response.freedom.index("rotor.x"), response.freedom.index("rotor.y")
    assert response.order.tolist() == [1.0]
    assert response.displacement[x, :, 0] == pytest.approx(whirl(speed), rel=1e-10)
    assert response.displacement[y, :, 0] == pytest.approx(-1j * whirl(speed), rel=1e-10)


@pytest.mark.parametrize("part", [0.5, 0.95, 1.0, 1.05, 1.8])
def test_the_steady_state_runs_on_the_circle(part):
    """Amplitude and phase to 1e-6, the drive's torque the work lost in the bearings."""
    speed = part * CRITICAL
    problem = periodic_problem(assemble(rotor()), speed, steps_per_cycle=120)
    orbit = find_orbit(problem, speed)
    assert orbit.status.usable
    path = motion(problem, orbit)
    here = path.displacement[0] + 1j * path.displacement[1]
    assert here * np.exp(-1j * speed * path.time) == pytest.approx(
        np.full(here.size, complex(whirl(np.array(speed)))), rel=1e-6
    )


def test_a_run_settles_on_the_circle():
    speed = 0.9 * CRITICAL
    run = simulate(rotor(speed, 2.5))
    here = run.displacement[0] + 1j * run.displacement[1]
    late = (run.time > 2.3) & (run.time < 2.4)
    turned = (here * np.exp(-1j * speed * run.time))[late]
    expected = complex(whirl(np.array(speed)))
    assert turned == pytest.approx(np.full(turned.size, expected), rel=2e-5)
    power = DAMPING * (speed * abs(expected)) ** 2
    assert np.mean(run.drive_torque[0, late]) * speed == pytest.approx(power, rel=1e-4)
    assert run.energy.relative < 1e-6


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_a_rotor_that_torques_alone_turn_pays_for_its_whirl(method):
    """Braked through the critical speed: what the motion across gains comes from the rotation."""
    scene = replace(
        rotor(),
        drives=(),
        free_rotations=(FreeRotation("rotor", "rotor", initial_speed=1.2 * CRITICAL),),
        loads=(LoadTorque("brake", "rotor", TimeLaw.constant(5.0)),),
        unbalances=(Unbalance("rotor", "rotor", 0.2, 20.0 * UNBALANCE, ANGLE),),
        gravity=(1.0, -9.81, 0.0),
        duration=0.3,
        outputs=Outputs(displacements=True, accelerations=True),
        integration=Integration(method=method, tolerance=1e-9),
    )
    run = simulate(scene)
    assert run.energy.relative < 1e-7
    braked = 5.0 * 0.3 / POLAR
    assert run.speed[0, -1] < 1.2 * CRITICAL - 3.0 * braked  # most of the loss is the whirl's


def test_forces_and_accelerations_of_an_unbalance_agree():
    """Of M q'' + ... = F(q''): Lagrange's equations written out for x, y and the angle."""
    system, u = _free(), 20.0 * UNBALANCE
    q, v = np.array([[1e-3, -2e-3, 0.4]]), np.array([[0.3, 0.5, 7.0]])
    spin, angle = CRITICAL + 7.0, ANGLE + 0.4
    mass = np.diag([MASS, MASS, POLAR])
    mass[0, 2] = mass[2, 0] = -u * math.sin(angle)
    mass[1, 2] = mass[2, 1] = u * math.cos(angle)
    force = -np.array([STIFFNESS, STIFFNESS, 0.0]) * q[0] - np.array([DAMPING, DAMPING, 0.0]) * v[0]
    force += np.array([0.0, -9.81 * MASS, -9.81 * u * math.cos(angle)])
    force += u * spin**2 * np.array([math.cos(angle), math.sin(angle), 0.0])
    expected = np.linalg.solve(mass, force)
    seen = observe(system.arrays, np.zeros(1), q, v).force[:, 0]
    balance = system.arrays.constant - system.arrays.stiffness @ q[0] - system.arrays.damping @ v[0]
    found = np.linalg.solve(system.arrays.mass, balance - system.arrays.direction.T @ seen)
    assert found == pytest.approx(expected, rel=1e-10)


def _free() -> System:
    """Return a rotor turned by nothing, at its critical speed, in gravity."""
    scene = replace(
        rotor(),
        drives=(),
        free_rotations=(FreeRotation("rotor", "rotor", initial_speed=CRITICAL),),
        unbalances=(Unbalance("rotor", "rotor", 0.2, 20.0 * UNBALANCE, ANGLE),),
        gravity=(0.0, -9.81, 0.0),
    )
    return assemble(scene)


def test_gravity_sags_the_rotor_and_leaves_its_frequencies():
    """In statics, in a steady state, in a run; the unbalance's weight turns the drive once a turn."""
    light = rotor(0.9 * CRITICAL)
    heavy = replace(light, gravity=(0.0, -9.81, 0.0), duration=2.5)
    system, sag = assemble(heavy), -9.81 * MASS / STIFFNESS
    assert static_equilibrium(system).displacement == pytest.approx([0.0, sag], abs=1e-12)
    assert natural_modes(system).frequency == pytest.approx(natural_modes(assemble(light)).frequency)
    problem = periodic_problem(system, 0.9 * CRITICAL)
    path = motion(problem, find_orbit(problem, 0.9 * CRITICAL))
    assert np.mean(path.displacement, axis=1) == pytest.approx([0.0, sag], abs=1e-9)
    run = simulate(heavy)
    late = (run.time > 2.2) & (run.time < 2.4)
    here = (run.displacement[0] + 1j * (run.displacement[1] - sag))[late]
    assert np.abs(here) == pytest.approx(np.full(here.size, abs(whirl(np.array(0.9 * CRITICAL)))), rel=1e-4)
    wave = np.exp(-1j * (0.9 * CRITICAL * run.time[late] + ANGLE))
    torque = run.drive_torque[0, late]
    weight = 2.0 * np.mean((torque - np.mean(torque)) * wave)
    assert abs(weight) == pytest.approx(9.81 * UNBALANCE, rel=0.02)


# Textbook benchmarks as scene files: what their sources and independent computations say.


ROTATIONAL = (1475.75, 1930.35, 2658.32, 7462.80, 11775.27)
TRANSLATIONAL = (743.16, 1102.42, 1896.02, 2276.38, 6986.30, 9647.91)


def example(name: str) -> Scene:
    return dynamic_scene(scene_of(EXAMPLES / name)[0], {})


def test_the_planetary_set_of_lin_and_parker_has_its_natural_frequencies():
    """Lin and Parker 1999, three planets: one of each rotational, two of each translational mode, Hz."""
    found = natural_modes(assemble(example("lin_parker_planetary_scene.toml"))).frequency
    expected = np.sort([*ROTATIONAL, *np.repeat(TRANSLATIONAL, 2)])
    assert found[-expected.size :] == pytest.approx(expected, rel=2e-6, abs=0.005)
    assert np.all(found[: -expected.size] < 1e-2)


@pytest.mark.parametrize(
    ("frequency", "rms"), [(0.5, 0.011759), (0.85, 0.181301), (1.0, 0.133083), (1.6, 0.057716)]
)
def test_the_oscillator_with_backlash_has_the_converged_response(frequency, rms):
    """Over W = 1 and more, and below the jumps, both branches are one; rms in half backlashes of 50 um."""
    text = tomllib.loads((EXAMPLES / "backlash_oscillator_scene.toml").read_text("utf-8"))
    shift = (frequency - 1.0) * text["drives"][0]["speed_rpm"][0]
    error = text["meshes"][0]["stiffness"]["transmission_error_um"]["amplitude"]
    error[0] = 50.0 * 0.05 * frequency / math.hypot(frequency, 0.1)
    text["drives"][0]["speed_rpm"][0] += shift
    text["speed_torques"][0]["speed_rpm"] = [s + shift for s in text["speed_torques"][0]["speed_rpm"]]
    text["outputs"]["sample_rate_hz"] *= frequency
    run = simulate(dynamic_scene(validated(SceneInput, text), {}))
    excited = error[0] * 1e-6 * np.cos(1e4 * frequency * run.time)
    deflection = (run.dynamic_transmission_error[0] - excited) / 50e-6
    assert np.std(deflection[-20 * 64 - 1 : -1]) == pytest.approx(rms, rel=1e-3)
