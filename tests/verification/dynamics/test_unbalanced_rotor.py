"""Jeffcott's rotor: closed forms of response, sag and weight, in linear response, steady states and runs."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dynamics import simulate
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


def test_the_response_has_amplitude_and_phase_through_the_critical_speed() -> None:
    speed = np.linspace(0.2, 2.0, 19) * CRITICAL
    response = forced_response(assemble(rotor()), speed, orders=3)
    x, y = response.freedom.index("rotor.x"), response.freedom.index("rotor.y")
    assert response.order.tolist() == [1.0]
    assert response.displacement[x, :, 0] == pytest.approx(whirl(speed), rel=1e-10)
    assert response.displacement[y, :, 0] == pytest.approx(-1j * whirl(speed), rel=1e-10)


@pytest.mark.parametrize("part", [0.5, 0.95, 1.0, 1.05, 1.8])
def test_the_steady_state_runs_on_the_circle(part: float) -> None:
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


def test_a_run_settles_on_the_circle() -> None:
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
def test_a_rotor_that_torques_alone_turn_pays_for_its_whirl(method: str) -> None:
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


def test_forces_and_accelerations_of_an_unbalance_agree() -> None:
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


def test_gravity_sags_the_rotor_and_leaves_its_frequencies() -> None:
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
