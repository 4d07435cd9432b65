"""Sound power of orders over a run: sums, weighting, third octaves, quadratic forms of modes."""

from __future__ import annotations

import numpy as np
import pytest
from hulls import box

from dynamics.acoustics import (
    Air,
    ElementalRadiators,
    OrderPower,
    a_weighting,
    modal_resistance,
    order_power,
    sound_power,
)
from dynamics.errors import InputError

SPEED = np.linspace(200.0, 500.0, 30)
FREQUENCY = np.array([1.0, 2.0, 3.0])[:, None] * SPEED
POWER = np.random.default_rng(5).uniform(1e-9, 1e-6, FREQUENCY.shape)


def test_levels_are_those_of_the_powers() -> None:
    orders = OrderPower(FREQUENCY, POWER)
    np.testing.assert_allclose(orders.level, 10.0 * np.log10(POWER / 1e-12))
    np.testing.assert_allclose(orders.weighted_level - orders.level, a_weighting(FREQUENCY), atol=1e-9)
    np.testing.assert_allclose(orders.total_level, 10.0 * np.log10(POWER.sum(axis=0) / 1e-12))
    assert np.all(orders.total_weighted_level >= orders.weighted_level.max(axis=0))


def test_third_octaves_hold_every_order_once() -> None:
    center, power = OrderPower(FREQUENCY, POWER).third_octaves()
    np.testing.assert_allclose(power.sum(axis=0), POWER.sum(axis=0), rtol=1e-12)
    assert list(center) == [200.0, 250.0, 315.0, 400.0, 500.0, 630.0, 800.0, 1000.0, 1250.0, 1600.0]
    tone, alone = OrderPower(np.array([[890.0, 892.0]]), np.array([[1.0, 1.0]])).third_octaves()
    np.testing.assert_array_equal(alone, [[1.0, 0.0], [0.0, 1.0]])  # 891.25 Hz parts 800 and 1000
    assert list(tone) == [800.0, 1000.0]


def test_modes_of_a_run_up_radiate_as_their_sum() -> None:
    hull, model, air = box((0.3, 0.2, 0.2), (5, 4, 4)), ElementalRadiators(), Air()
    shapes = np.stack([np.ones(len(hull.areas)), hull.centers[:, 0], hull.normals[:, 1]], axis=1)
    made = modal_resistance(model, hull, np.array([200.0, 400.0, 600.0]), shapes, air)
    velocity = np.random.default_rng(6).normal(size=(2, 3, 3)) * (1.0 + 0.5j)
    frequency = np.array([[200.0, 400.0, 600.0], [400.0, 400.0, 600.0]])
    whole = order_power(made, frequency, velocity)
    alone = sound_power(model, hull, 400.0, shapes @ velocity[1, 0], air)
    assert whole.power[1, 0] == pytest.approx(alone, rel=1e-9)
    np.testing.assert_allclose(
        order_power(made, frequency, 3.0 * velocity).power, 9.0 * whole.power, rtol=1e-9
    )


def test_what_is_no_power_over_frequency_is_refused() -> None:
    with pytest.raises(InputError, match="power"):
        OrderPower(FREQUENCY, POWER[:-1])
    with pytest.raises(InputError, match="above 0 Hz"):
        OrderPower(0.0 * FREQUENCY, POWER)
    with pytest.raises(InputError, match="at least 0 W"):
        OrderPower(FREQUENCY, -POWER)
