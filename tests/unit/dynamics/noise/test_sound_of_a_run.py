"""Sound power of the orders of a run: that of the linear response where the scene is linear; scaling."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table
from sounding_housings import part_of_scene
from sounding_scene import ON, housing
from swept_runs import BEARINGS, drawn_amplitudes, order_forces, swept_run

from dynamics.acoustics import EquivalentRadiatedPower
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import forced_response
from dynamics.loads import TimeLaw
from dynamics.noise import housing_radiation, radiated_sound
from dynamics.orders import bearing_orders
from dynamics.simulation import simulate
from dynamics.vibration import analyze_vibration, housing_vibration

ORDERS = 3
ERRORS = ((0.5e-6, 0.3), (0.3e-6, 1.1), (0.2e-6, -0.8))  # m and rad, by order


def linear_table():
    """A constant stiffness, so that the linear response is the whole answer; an error of three orders."""
    table = spring_table(3e8)
    angle = 2.0 * np.pi * np.outer(np.arange(1, ORDERS + 1), table.position)
    size, phase = (np.array(column)[:, None] for column in zip(*ERRORS, strict=True))
    error = np.sum(size * np.cos(angle + phase), axis=0)
    slope = np.sum(-size * 2.0 * np.pi * np.arange(1, ORDERS + 1)[:, None] * np.sin(angle + phase), axis=0)
    return replace(
        table,
        deflection=table.deflection + error[:, None],
        deflection_slope=0.0 * table.deflection + slope[:, None],
    )


def linear_scene(speed: TimeLaw, duration: float):
    scene = gear_pair_scene(linear_table(), effects=ON, speed=speed, duration=duration)
    return replace(scene, housings=(part_of_scene(housing()),))


@cache
def radiation():
    return housing_radiation(housing(), EquivalentRadiatedPower(), [50.0, 3000.0])


def level_difference(scene, found, rows):
    """Levels of the orders of a run less those of the linear response at the same speeds, (S, H), dB."""
    linear = forced_response(assemble(scene), found.speed[rows], orders=ORDERS)
    body = housing()
    by_run, by_response = (radiated_sound(each, body, None, radiation()) for each in (found, linear))
    return by_run.orders.level.T[rows] - by_response.orders.level.T


def test_a_run_at_constant_speed_sounds_as_the_linear_response():
    """With the phases of the forces, those of all bearings and orders."""
    scene = linear_scene(TimeLaw.constant(150.0), 0.4)
    found = bearing_orders(simulate(scene), ORDERS)
    settled = slice(-3, None)
    expected = forced_response(assemble(scene), [150.0], orders=ORDERS).bearing_force
    near = np.broadcast_to(expected, found.bearing_force[..., settled, :].shape)
    np.testing.assert_allclose(found.bearing_force[..., settled, :], near, atol=1e-4 * np.abs(near).max())
    even = replace(found, speed=found.speed + 1e-6 * np.arange(found.speed.size))
    assert np.abs(level_difference(scene, even, settled)).max() < 0.01
    assert found.remainder[:, settled].max() < 1e-6


def test_a_slow_run_up_sounds_as_the_linear_response_at_its_speeds():
    scene = linear_scene(TimeLaw.ramp(100.0, 110.0, 2.0), 2.0)
    found = bearing_orders(simulate(scene), ORDERS)
    settled = slice(found.time.size // 4, None, 20)
    assert found.smearing.max() < 10.0 ** (0.1 / 20.0) - 1.0
    assert np.abs(level_difference(scene, found, settled)).max() < 0.1


def test_power_goes_with_the_square_of_the_load_and_bearings_superpose():
    amplitudes = drawn_amplitudes(ORDERS)
    sounds = [
        radiated_sound(
            bearing_orders(swept_run(300.0, 900.0, 1.0, order_forces(amplitudes, scale)), ORDERS),
            housing(),
            None,
            radiation(),
        )
        for scale in (1.0, 2.0)
    ]
    np.testing.assert_allclose(sounds[1].power, 4.0 * sounds[0].power, rtol=1e-6)
    np.testing.assert_allclose(sounds[0].bearing_share.sum(axis=0), sounds[0].power, rtol=1e-9)


def test_forces_that_go_with_the_speed_as_in_a_steady_state():
    """A sweep of constant amplitudes: at each speed the power of these forces at that frequency."""
    amplitudes = drawn_amplitudes(ORDERS)
    found = bearing_orders(swept_run(300.0, 900.0, 1.0, order_forces(amplitudes)), ORDERS)
    exact = np.broadcast_to(amplitudes[:, :, None], found.bearing_force.shape)
    expected = radiated_sound(replace(found, bearing_force=exact), housing(), None, radiation())
    np.testing.assert_allclose(
        radiated_sound(found, housing(), None, radiation()).power, expected.power, rtol=1e-5
    )
    vibration = housing_vibration(found, housing())
    assert vibration.mean_square_velocity.shape == found.frequency.shape
    analysis = analyze_vibration(found, housing(), "case")
    assert analysis.facts["pitches"] == found.facts["pitches"]


def test_bearings_of_the_run_that_are_not_those_of_the_seats_are_refused():
    names = ("input left", *BEARINGS[1:])
    run = swept_run(300.0, 900.0, 0.2, order_forces(drawn_amplitudes(ORDERS)), bearings=names)
    with pytest.raises(InputError, match=r"bearings\[0\] = 'input.left'.*one of input left"):
        radiated_sound(bearing_orders(run, ORDERS), housing(), None, radiation())
