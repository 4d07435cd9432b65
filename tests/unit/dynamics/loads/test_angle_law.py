"""An angle over time: its speed, acceleration, and what a run makes of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene

from dynamics.arrays.arrays import slope
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.joints import ImposedRotation
from dynamics.loads import AngleLaw
from dynamics.motion.observation import observe_laws
from dynamics.scene import Integration
from dynamics.simulation import simulate

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
