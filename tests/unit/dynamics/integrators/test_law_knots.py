"""Steps end where the acceleration of an imposed motion jumps: no impulse is lost, none is made up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, gear_pair_scene, spring_table, with_mesh

from dynamics.assembly.assemble import assemble
from dynamics.integrators import integrate, static_equilibrium
from dynamics.integrators.workspace import Count
from dynamics.loads import AngleLaw, TimeLaw
from dynamics.scene import Integration, Outputs
from dynamics.simulation import simulate

STIFFNESS = 4e8
INERTIA = 1.1344291072112745e-3
NATURAL = np.sqrt(STIFFNESS * BASE_RADIUS**2 / INERTIA)
KNOTS, SPEEDS = (0.0, 0.0101, 0.0202, 0.0304), (10.0, 30.0, 20.0, 50.0)


def torsional(speed, **changes):
    """The driven shaft alone on a mesh of constant stiffness, undamped."""
    scene = gear_pair_scene(spring_table(STIFFNESS), speed=speed, duration=0.04)
    outputs = Outputs(20e3, anti_alias=False)
    return with_mesh(replace(scene, bushings=(), effects={}, outputs=outputs, **changes), damping=0.0)


def ringing(time):
    """Closed form: the inertial force INERTIA a/r on the mesh steps at every knot, and each step rings on."""
    accelerations = [*(np.diff(SPEEDS) / np.diff(KNOTS)), 0.0]
    error = (100.0 + INERTIA * accelerations[0]) / BASE_RADIUS / STIFFNESS * np.ones_like(time)
    for knot, jump in zip(KNOTS[1:], np.diff(accelerations), strict=True):
        since = np.maximum(time - knot, 0.0)
        error += INERTIA * jump / BASE_RADIUS / STIFFNESS * (1.0 - np.cos(NATURAL * since))
    return error


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_every_knot_of_a_speed_law_rings_as_the_closed_form(method):
    scene = torsional(TimeLaw(KNOTS, SPEEDS), integration=Integration(method, tolerance=1e-11))
    result = simulate(scene)
    exact = ringing(result.time)
    assert np.ptp(exact) > 3e-7
    assert np.max(np.abs(result.dynamic_transmission_error[0] - exact)) < 2e-10
    assert abs(result.energy.residual) < 1e-9 * result.energy.kinetic


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_a_jump_costs_no_energy_at_any_tolerance(method):
    """A wrong speed after a jump shows in the balance, though the displacements are right."""
    kicked = torsional(TimeLaw(KNOTS, SPEEDS), integration=Integration(method, tolerance=1e-8))
    energy = simulate(kicked).energy
    assert abs(energy.residual) < 1e-6 * energy.kinetic


def test_a_run_ends_at_a_knot_at_its_end():
    scene = torsional(TimeLaw.ramp(0.0, 100.0, 0.04))
    system = assemble(scene)
    run = integrate(system, static_equilibrium(system), scene.integration)
    assert run.end == 0.04
    assert run.time.size == 801


def steps(speed):
    system = assemble(torsional(speed))
    run = integrate(system, static_equilibrium(system), system.scene.integration)
    return int(run.count[Count.ACCEPTED])


def test_smooth_laws_are_not_stopped_at():
    """A spline through 400 angles has no jump of the acceleration: it runs in as many steps as one of 40."""

    def spline(points):
        time = np.linspace(0.0, 0.04, points)
        return AngleLaw(tuple(time), tuple(30.0 * time + 100.0 * time**2))

    assert steps(spline(400)) < 1.05 * steps(spline(40))
