"""Sliding along the path of contact, against velocities of rigid bodies."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from fe_contact.geometry import (
    Gear,
    GearPair,
    InternalGearPair,
    ParallelAxes,
    RingGear,
    sliding_factor,
    specific_sliding,
)


def external(make_gear: Callable[..., Gear]) -> ParallelAxes:
    return GearPair(make_gear(teeth=23, profile_shift_coefficient=0.3), make_gear(teeth=47))


def internal(make_gear: Callable[..., Gear]) -> ParallelAxes:
    module = make_gear(teeth=36).normal_module
    ring = RingGear(96, module, 0.02, rim_diameter=110 * module, addendum_coefficient=0.9)
    return InternalGearPair(make_gear(teeth=36), ring)


def tangential_speeds(pair: ParallelAxes, roll: float) -> tuple[float, float]:
    """Speed of either flank across the line of action at 1 rad/s of the pinion, from omega x r."""
    alpha = pair.working_pressure_angle
    along, across = (math.cos(alpha), math.sin(alpha)), (math.sin(alpha), -math.cos(alpha))
    foot = pair.pinion.base_radius * np.array([-math.sin(alpha), math.cos(alpha)])
    touch = foot + roll * np.array(along)
    centers = np.array([0.0, 0.0]), np.array([0.0, pair.wheel.sign * pair.center_distance])
    omegas = -1.0, pair.wheel.sign / pair.speed_ratio  # the pinion drives clockwise
    speeds = []
    for center, omega in zip(centers, omegas, strict=True):
        arm = touch - center
        speeds.append(float(np.dot(omega * np.array([-arm[1], arm[0]]), across)))
    return speeds[0], speeds[1]


@pytest.mark.parametrize("make_pair", [external, internal])
def test_sliding_is_the_difference_of_the_flanks_velocities(
    make_gear: Callable[..., Gear], make_pair: Callable[..., ParallelAxes]
) -> None:
    pair = make_pair(make_gear)
    for roll in pair.path_of_contact.points:
        first, second = tangential_speeds(pair, roll)
        pitch_line = pair.operating_pitch_radii[0]
        assert sliding_factor(pair, roll) == pytest.approx((first - second) / pitch_line, abs=1e-12)
        assert specific_sliding(pair, roll) == pytest.approx(
            ((first - second) / first, (second - first) / second), abs=1e-12
        )


def test_sliding_changes_its_sense_at_the_pitch_point(make_gear: Callable[..., Gear]) -> None:
    pair = external(make_gear)
    a, _, c, _, e = (float(sliding_factor(pair, roll)) for roll in pair.path_of_contact.points)
    assert a < 0.0 < e
    assert c == pytest.approx(0.0, abs=1e-14)


def test_specific_sliding_of_equal_spur_gears_by_hand() -> None:
    """20/20, module 4: at A the roll lengths are sqrt(37.8548^2 - 37.5877^2) = 4.489 and 22.873 mm."""
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    pair = GearPair(gear, gear, 80e-3)
    first, second = specific_sliding(pair, pair.path_of_contact.start)
    assert float(first) == pytest.approx(1.0 - 22.873 / 4.489, abs=2e-3)
    assert float(second) == pytest.approx(1.0 - 4.489 / 22.873, abs=2e-4)


@pytest.mark.parametrize("make_pair", [external, internal])
def test_tips_clear_the_mating_roots_by_dedendum_less_addendum(
    make_gear: Callable[..., Gear], make_pair: Callable[..., ParallelAxes]
) -> None:
    pair = make_pair(make_gear)
    low, high = pair.tip_clearances
    nearest = pair.center_distance if not pair.internal else -pair.center_distance
    assert low == pytest.approx(nearest - pair.wheel.sign * pair.wheel.root_radius - pair.pinion.tip_radius)
    assert high == pytest.approx(nearest - pair.wheel.sign * pair.wheel.tip_radius - pair.pinion.root_radius)
    assert min(low, high) > 0.1 * pair.pinion.normal_module
