"""Trains that only torques move: unlimited rotation, exact phase, rigid acceleration."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, gear_pair_scene, spring_table
from mesh_phases import flank_phase

from dynamics import FreeRotation, Integration, LoadTorque, Outputs, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.integrators import static_equilibrium
from dynamics.motion.motion import QUANTUM, move_free_trains, write_motion

PI = Fraction(3141592653589793238462643383279502884197, 10**39)


def free_scene(speed=50.0, motor=-120.0, brake=100.0, duration=0.05, table=None, **changes):
    """The 20/20 pair with a motor torque on the input and a brake on the output."""
    scene = gear_pair_scene(table or spring_table(4e8, 1e-6), duration=duration, torque=brake)
    loads = (LoadTorque("motor", "input", TimeLaw.constant(motor)), *scene.loads)
    free = (FreeRotation("train", "input", speed),)
    return replace(scene, drives=(), free_rotations=free, loads=loads, **changes)


def test_unbalanced_torques_accelerate_the_train_as_a_rigid_one():
    scene = free_scene()
    result = simulate(scene)
    inertia = assemble(scene).arrays.total_inertia[0, 0]
    expected = 50.0 + 20.0 / inertia * result.time
    np.testing.assert_allclose(result.speed[0], expected, rtol=2e-3)
    assert result.speed[0, -1] == pytest.approx(expected[-1], rel=1e-4)
    np.testing.assert_allclose(result.speed[1], -expected, rtol=2e-3)
    assert result.energy.relative < 1e-3
    assert result.mesh_frequency[0, -1] == pytest.approx(
        20.0 * result.speed[0, -1] / (2.0 * math.pi), rel=1e-9
    )


def test_the_position_is_that_of_the_turned_angle():
    result = simulate(free_scene(duration=0.2, outputs=Outputs(20e3)))
    turned = np.concatenate([[0.0], np.cumsum(0.5 * (result.speed[0, 1:] + result.speed[0, :-1]))])
    turned *= result.time[1] / (2.0 * math.pi) * 20.0
    assert turned[-1] > 30.0
    difference = result.position[0] - result.position[0, 0] - turned
    assert np.max(np.abs(difference - np.round(difference))) < 1e-4


def test_the_start_is_an_equilibrium_of_the_accelerating_train():
    system = assemble(free_scene(table=spring_table(4e8)))
    start = static_equilibrium(system)
    assert start.status.usable
    assert start.mesh_force[0] == pytest.approx(110.0 / BASE_RADIUS, rel=1e-9)  # the mean of motor and brake
    assert system.flanks.nominal_force[0] == pytest.approx(110.0 / BASE_RADIUS, rel=1e-12)
    assert np.ptp(simulate(free_scene(table=spring_table(4e8))).mesh_force) < 1e-4


def test_a_free_and_an_imposed_train_move_alike():
    """At balanced torques the light side does what it does against an imposed constant speed."""
    scene = free_scene(motor=-100.0, table=spring_table(4e8, 1e-6))
    heavy = replace(scene.shafts[0], inertia=replace(scene.shafts[0].inertia, polar=1e6))
    scene = replace(scene, shafts=(heavy, scene.shafts[1]), integration=Integration(tolerance=1e-11))
    imposed = gear_pair_scene(spring_table(4e8, 1e-6), speed=TimeLaw.constant(50.0), duration=0.05)
    imposed = replace(imposed, integration=Integration(tolerance=1e-11))
    free, held = simulate(scene), simulate(imposed)
    scale = np.ptp(held.dynamic_transmission_error)
    np.testing.assert_allclose(
        free.dynamic_transmission_error, held.dynamic_transmission_error, atol=1e-4 * scale
    )


def test_the_phase_loses_nothing_over_ten_million_steps():
    """10^7 steps of one base pitch and a bit: position against exact rational arithmetic."""
    reference = assemble(free_scene(speed=0.0)).arrays.reference
    step, steps = 0.31830988618379067, 10_000_000
    motion, moved, q = np.empty((1, 4)), np.zeros(1, dtype=np.int64), np.zeros(reference.vector.shape[1])
    own = int(reference.freedom[0])
    # one call moves what 1000 steps turned: rounding of q enters 10^4 times, that of the count never
    for _ in range(steps // 1000):
        q += reference.vector[0] * (1000 * step)
        move_free_trains_py(reference, moved, q)
    write_motion(reference, 0.0, moved, motion)
    position = flank_phase(reference, 0, motion) + q[own] * 20.0 / (2.0 * math.pi)
    assert abs(q[own]) <= 0.5 * QUANTUM
    assert moved[0] * QUANTUM * 20 / (2.0 * math.pi) > 1e7  # base pitches
    exact = float(Fraction(1000 * step) * (steps // 1000) * 20 / (2 * PI) % 1)
    error = position - exact
    assert abs(error - round(error)) < 1e-9


def move_free_trains_py(reference, moved, q):
    move_free_trains.py_func(reference, moved, q)


def test_moving_a_train_on_changes_no_transmission_error():
    system = assemble(free_scene()).arrays
    rng = np.random.default_rng(1)
    small = rng.normal(size=system.mass.shape[0]) * 1e-6
    q = small + system.reference.vector[0] * 3.0
    moved = np.zeros(1, dtype=np.int64)
    before = system.direction @ q, system.stiffness @ q
    move_free_trains_py(system.reference, moved, q)
    assert moved[0] > 400_000
    np.testing.assert_allclose(system.direction @ q, before[0], atol=1e-15)
    np.testing.assert_allclose(system.stiffness @ q, before[1], atol=1e-7)


def test_a_start_from_rest_needs_only_a_sense():
    scene = free_scene(speed=0.0, duration=0.02)
    result = simulate(scene)
    assert result.speed[0, -1] > 5.0
    assert result.speed[1, -1] < -5.0
    with pytest.raises(InputError, match="sense"):
        FreeRotation("f", "input", -3.0)


def test_a_train_needs_a_drive_or_a_free_rotation():
    with pytest.raises(InputError, match="free rotation"):
        replace(free_scene(), free_rotations=())
