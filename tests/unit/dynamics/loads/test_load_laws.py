"""Laws of loads: over angle, time and speed."""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table

from dynamics import FreeRotation, ImposedRotation, Integration, TimeLaw, simulate
from dynamics.arrays.arrays import revolutions, slope
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.forces import SpeedTorque
from dynamics.loads import AngleLaw, SpeedCurve
from dynamics.motion.observation import observe_laws

# An angle over time: its speed, acceleration, and what a run makes of it.


TIME = tuple(np.linspace(0.0, 0.1, 41).tolist())
ANGLE = tuple(50.0 * t + 0.2 * np.sin(2 * np.pi * 30.0 * t) for t in TIME)


def test_speed_and_acceleration_are_those_of_the_angle():
    law = AngleLaw(TIME, ANGLE)
    middle = np.linspace(0.02, 0.08, 61)
    speed = 50.0 + 0.2 * 2 * np.pi * 30.0 * np.cos(2 * np.pi * 30.0 * middle)
    np.testing.assert_allclose(law(middle), speed, rtol=2e-3)
    between = 0.0507  # of two knots
    rise = (law(between + 1e-7) - law(between - 1e-7)) / 2e-7
    assert slope(law, np.array([between]))[0] == pytest.approx(rise, rel=1e-4)
    assert law(0.2) == law(0.1)
    errors = []
    for points in (21, 41, 81):
        t = np.linspace(0.0, 0.1, points)
        found = AngleLaw(tuple(t), tuple(np.sin(2 * np.pi * 30.0 * t)))(middle)
        errors.append(np.max(np.abs(found - 2 * np.pi * 30.0 * np.cos(2 * np.pi * 30.0 * middle))))
    assert np.log2(errors[0] / errors[2]) / 2.0 == pytest.approx(3.0, abs=0.4)  # order of a spline's slope


def test_the_reference_turns_through_the_given_angles():
    scene = gear_pair_scene(duration=0.1)
    scene = replace(scene, drives=(ImposedRotation("d", "input", AngleLaw(TIME, ANGLE)),))
    whole, fraction, speed, _ = observe_laws(assemble(scene).arrays, np.array(TIME))
    turned = 2.0 * np.pi * (whole[0] + fraction[0])
    np.testing.assert_allclose(turned - turned[0], np.array(ANGLE) - ANGLE[0], atol=1e-12)
    result = simulate(scene)
    assert result.energy.relative_to_throughput < 1e-6
    fine = simulate(replace(scene, integration=Integration(tolerance=1e-12)))
    assert fine.energy.relative < 1e-3
    np.testing.assert_allclose(result.speed[0, ::50], AngleLaw(TIME, ANGLE)(result.time[::50]), rtol=1e-12)
    assert speed[0, -1] == pytest.approx(result.speed[0, -1])


@pytest.mark.parametrize(
    ("time", "angle", "field"),
    [
        ((0.0, 1.0, 2.0), (0.0, 1.0, 2.0), "time"),
        ((0.0, 1.0, 1.0, 2.0), (0.0,) * 4, "time"),
        ((0.0, 1.0, 2.0, 3.0), (0.0,) * 3, "angle"),
        ((0.0, 1.0, 2.0, 3.0), (0.0, 1.0, np.nan, 2.0), "angle[2]"),
    ],
)
def test_bad_tables_are_refused(time, angle, field):
    with pytest.raises(InputError) as caught:
        AngleLaw(time, angle)
    assert caught.value.field == field


# Laws of time: values, exact integrals, refusals.


LAWS = [
    TimeLaw.constant(7.0),
    TimeLaw.ramp(0.0, 100.0, 5.0),
    TimeLaw.ramp(-20.0, 80.0, 2.0, begin=1.0, shape="smooth"),
    TimeLaw((-1.0, 0.5, 2.0, 4.0), (3.0, -5.0, 40.0, 0.0)),
]


def test_a_ramp_runs_straight_and_holds():
    law = TimeLaw.ramp(10.0, 30.0, 4.0, begin=1.0)
    np.testing.assert_allclose(law(np.array([-9.0, 1.0, 3.0, 5.0, 99.0])), [10, 10, 20, 30, 30])


def test_a_smooth_ramp_has_no_corner():
    law = TimeLaw.ramp(0.0, 1.0, 1.0, shape="smooth")
    step = 1e-5
    for knot in (0.0, 1.0):
        slopes = [(law(knot + step) - law(knot)) / step, (law(knot) - law(knot - step)) / step]
        np.testing.assert_allclose(slopes, 0.0, atol=1e-4)
    assert law(0.5) == pytest.approx(0.5)


@pytest.mark.parametrize("law", LAWS)
def test_revolutions_are_the_integral_from_time_zero(law):
    whole, fraction = revolutions(law)
    start, _ = law.polynomials()
    for piece, begin in enumerate(start):
        grid = np.linspace(0.0, begin, 400_001)
        angle = np.trapezoid(law(grid), grid)
        assert whole[piece] + fraction[piece] == pytest.approx(angle / (2 * math.pi), abs=1e-8)
    assert np.all((fraction >= 0.0) & (fraction < 1.0))


@pytest.mark.parametrize(
    ("time", "value", "shape", "field"),
    [
        ((1.0, 1.0), (0.0, 1.0), "linear", "time"),
        ((0.0, 1.0), (0.0,), "linear", "value"),
        ((0.0, 1.0), (0.0, math.nan), "linear", "value[1]"),
        ((0.0, 1.0), (0.0, 1.0), "cubic", "shape"),
        ((), (), "linear", "time"),
    ],
)
def test_bad_laws_are_refused_by_name(time, value, shape, field):
    with pytest.raises(InputError) as caught:
        TimeLaw(time, value, shape)
    assert caught.value.field == field


# Torques by speed: curves, terminal speed, run-up against closed forms, power.


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
    for rise in (-2.0, 2.0):
        curve = SpeedCurve.table([0.0, 200.0], [50.0 - 40.0 * rise, 50.0 + 160.0 * rise])
        load = SpeedTorque("load", "output", curve)
        scene = scene_by_speed(
            load, speed=TimeLaw.constant(40.0), table=spring_table(4e8, 1e-6), duration=0.01
        )
        scene = replace(scene, meshes=(replace(scene.meshes[0], damping=0.0),))
        result = simulate(replace(scene, integration=Integration(tolerance=1e-11)))
        error = result.dynamic_transmission_error[0]
        swing[rise] = np.ptp(error[result.time > 0.008])
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
