"""Torques by speed: curves, terminal speed, run-up against closed forms, power."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.forces import SpeedTorque
from dynamics.joints import FreeRotation
from dynamics.loads import SpeedCurve, TimeLaw
from dynamics.scene import Integration
from dynamics.simulation import simulate

DRY = SpeedCurve.constant(1.0, 1.0)


def scene_by_speed(*torques, speed=None, **changes):
    """The pair on springs without ripple; a free train unless the input's `speed` is imposed."""
    table = changes.pop("table", spring_table(4e8))
    scene = gear_pair_scene(table, speed=speed, **changes)
    scene = replace(scene, loads=(), speed_torques=torques, bushings=())
    if speed is not None:
        return scene
    return replace(scene, drives=(), free_rotations=(FreeRotation("train", "input", 0.0),))


def inertia_of(scene):
    return assemble(scene).arrays.total_inertia[0, 0]


def test_curves_are_their_closed_forms():
    fan = SpeedCurve.quadratic(40.0, 100.0)
    np.testing.assert_allclose(fan(np.array([-50.0, 0.0, 50.0, 200.0])), [-10.0, 0.0, 10.0, 160.0])
    dry = SpeedCurve.constant(7.0, 0.5)
    np.testing.assert_allclose(
        dry(np.array([-9.0, -0.5, 0.0, 0.5, 9.0])), [-7.0, -7.0, 0.0, 7.0, 7.0], atol=1e-12
    )
    inside = dry(np.linspace(-0.5, 0.5, 101))
    assert np.all(np.diff(inside) > 0.0)
    table = SpeedCurve.table([0.0, 100.0, 150.0], [-50.0, -40.0, 0.0])
    np.testing.assert_allclose(
        table(np.array([-5.0, 0.0, 100.0, 150.0, 900.0])), [-50.0, -50.0, -40.0, 0.0, 0.0]
    )
    between = table(np.linspace(0.0, 150.0, 301))
    assert np.all(np.diff(between) >= 0.0)


def test_a_motor_runs_a_fan_up_as_the_closed_form_says():
    """I w' = T - c w^2: w = w_e tanh(t sqrt(T c) / I)."""
    motor = SpeedTorque("motor", "input", SpeedCurve.table([0.0, 1e4], [-60.0, -60.0]))
    fan = SpeedTorque("fan", "output", SpeedCurve.quadratic(60.0, 80.0))
    scene = scene_by_speed(motor, fan, duration=0.01)
    scene = replace(scene, integration=Integration(tolerance=1e-10))
    inertia = inertia_of(scene)
    duration = 1.5 * inertia * 80.0 / 60.0
    result = simulate(replace(scene, duration=duration))
    expected = 80.0 * np.tanh(result.time * 60.0 / (80.0 * inertia))
    mean = 0.5 * (result.speed[0] - result.speed[1])  # the mesh winds up between equal inertias
    # while it winds up the fan lags by 0.009 rad/s, which makes 0.004 rad/s of the mean
    np.testing.assert_allclose(mean, expected, atol=0.005)
    assert result.speed[0, -1] > 70.0
    assert result.energy.relative_to_throughput < 1e-6
    assert result.energy.kinetic == pytest.approx(0.5 * inertia * mean[-1] ** 2, rel=0.02)


def test_dry_friction_stops_the_train_and_holds_it():
    """Constant torque: it stops after I w / T seconds, and does not turn back."""
    brake = SpeedTorque("brake", "output", SpeedCurve.constant(50.0, 0.05))
    scene = replace(scene_by_speed(brake), free_rotations=(FreeRotation("train", "input", 20.0),))
    stop = inertia_of(scene) * 20.0 / 50.0
    result = simulate(replace(scene, duration=3.0 * stop))
    mean = 0.5 * (result.speed[0] - result.speed[1])
    assert np.interp(0.5 * stop, result.time, mean) == pytest.approx(10.0, abs=0.02)
    after = result.speed[1, result.time > 2.0 * stop]  # the other shaft may bounce off its flank
    assert np.max(np.abs(after)) < 0.05


def test_on_an_imposed_shaft_it_is_a_load_of_the_drive():
    fan = SpeedTorque("fan", "output", SpeedCurve.quadratic(60.0, 80.0))
    own = SpeedTorque("pump", "input", SpeedCurve.table([0.0, 200.0], [5.0, 25.0]))
    law = TimeLaw.constant(40.0)
    scene = scene_by_speed(fan, own, speed=law, duration=0.02)
    result = simulate(scene)
    assert result.drive_torque[0].mean() == pytest.approx(15.0 + 9.0, rel=1e-6)
    np.testing.assert_allclose(result.mesh_force[0], result.nominal_force[0], rtol=1e-6)
    assert result.energy.load == pytest.approx(-result.energy.drive, rel=1e-6)
    assert result.energy.load < -24.0 * 40.0 * 0.02
    assert result.energy.relative_to_throughput < 1e-7


def test_a_rising_curve_damps_and_a_falling_one_feeds():
    """The slope dT/dw at the speed of operation acts as a damper: it leaves the energy's balance closed."""
    swing = {}
    for slope in (-2.0, 2.0):
        curve = SpeedCurve.table([0.0, 200.0], [50.0 - 40.0 * slope, 50.0 + 160.0 * slope])
        load = SpeedTorque("load", "output", curve)
        scene = scene_by_speed(
            load, speed=TimeLaw.constant(40.0), table=spring_table(4e8, 1e-6), duration=0.01
        )
        scene = replace(scene, meshes=(replace(scene.meshes[0], damping=0.0),))
        result = simulate(replace(scene, integration=Integration(tolerance=1e-11)))
        error = result.dynamic_transmission_error[0]
        swing[slope] = np.ptp(error[result.time > 0.008])
    assert swing[-2.0] > 2.0 * swing[2.0]


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: SpeedCurve.table([0.0], [1.0]), "torque"),
        (lambda: SpeedCurve.table([0.0, 0.0], [1.0, 2.0]), "speed"),
        (lambda: SpeedCurve.table([0.0, 1.0], [1.0, math.nan]), "torque[1]"),
        (lambda: SpeedCurve.quadratic(1.0, 0.0), "speed"),
        (lambda: SpeedCurve.constant(1.0, 0.0), "fade"),
        (lambda: SpeedCurve((0.0,), ((0.0,) * 4,)), "coefficient"),
        (
            lambda: scene_by_speed(SpeedTorque("x", "nobody", SpeedCurve.constant(1.0, 1.0))),
            "speed_torques[0].shaft",
        ),
    ],
)
def test_bad_curves_are_refused(make, field):
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.field == field
