"""Vibration of a housing in a forced response, and how far the modes kept carry it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, square_wave_table
from reduced_housings import PAIR, random_housing

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.housings import scene_housing
from dynamics.linearize import forced_response
from dynamics.vibration import (
    MotionQuantity,
    analyze_vibration,
    housing_motion,
    housing_vibration,
    overall,
    seat_forces,
)

ON = {"lateral": "on", "axial": "on", "tilt": "on", "housing_modes": "on"}
SPEEDS = np.array([60.0, 150.0, 420.0])


@pytest.fixture(scope="module")
def response():
    part = replace(scene_housing(random_housing(), "case"), seat_positions=None)
    scene = replace(gear_pair_scene(square_wave_table(), effects=ON), housings=(part,))
    return forced_response(assemble(scene), SPEEDS, orders=4)


def test_points_move_under_the_forces_of_the_bearings(response):
    housing = random_housing()
    found = housing_vibration(response, housing, points=("b",))
    motion = housing_motion(housing, response.frequency, seat_forces(response, housing))
    moved = motion[2, 1] @ housing.points[1].motion.T
    omega = 2.0 * np.pi * response.frequency[2, 1]
    assert found.point == ("b",)
    np.testing.assert_allclose(found.velocity[0, :, 2, 1], 1j * omega * moved, rtol=1e-9)
    np.testing.assert_allclose(found.of(MotionQuantity.DISPLACEMENT)[0, :, 2, 1], moved, rtol=1e-9)
    acceleration = found.of(MotionQuantity.ACCELERATION)[0, :, 2, 1]
    np.testing.assert_allclose(acceleration, -(omega**2) * moved, rtol=1e-9)
    assert found.rms[0, 2, 1] == pytest.approx(np.linalg.norm(found.velocity[0, :, 2, 1]) / np.sqrt(2.0))
    assert overall([3.0, 4.0]) == pytest.approx(5.0)


def test_harmonics_above_seven_tenths_of_the_highest_mode_are_not_valid_nor_the_largest(response):
    housing = random_housing()
    highest = float(response.frequency[2, 1]) / 0.7 + 1.0
    few = replace(housing, frequency=np.array([0.5 * highest, highest]))
    found = housing_vibration(response, few)
    assert found.highest_valid_frequency == pytest.approx(0.7 * highest)
    assert np.array_equal(found.valid, response.frequency <= 0.7 * highest)
    assert not found.valid[2, 2]
    loud = replace(found, velocity=np.where(found.valid, found.velocity, 1e3))
    assert loud.valid[loud.largest()]
    assert found.rms.max(axis=0)[found.largest()] == np.max(found.rms.max(axis=0)[found.valid])
    assert found.largest(speed=500.0, order=3.0) == (2, 2)  # what is asked for may be beyond
    assert found.largest(speed=100.0)[0] == 0


def test_a_point_that_is_not_there_is_refused(response):
    with pytest.raises(InputError, match="one of a, b"):
        housing_vibration(response, random_housing(), points=("c",))
    with pytest.raises(InputError, match="named point"):
        housing_vibration(response, replace(random_housing(), points=()), points=("c",))
    assert housing_vibration(response, replace(random_housing(), points=())).velocity.shape == (0, 3, 3, 4)


def test_an_analysis_looks_where_the_motion_is_largest_and_says_what_makes_it(response):
    housing = random_housing()
    found = analyze_vibration(response, housing, "case")
    at = found.at_speed, found.at_order
    assert at == found.vibration.largest()
    hertz = response.frequency[at]
    moved = np.einsum("ns,s->n", found.mobilities.point[1, 2], found.vibration.seat_force[at])
    nearest = np.argmin(np.abs(found.mobilities.frequency - hertz))
    assert abs(found.mobilities.frequency[nearest] - hertz) < hertz / 400.0
    assert abs(moved[nearest]) == pytest.approx(abs(found.vibration.velocity[1, 2][at]), rel=0.1)
    assert found.mobilities.seat[5] == "input.right x"
    for shares in (found.bearings, found.modes):
        np.testing.assert_allclose(shares.point.sum(axis=1), 1.0)
        assert np.all(np.isnan(shares.surface))
    assert found.bearings.name == PAIR
    assert found.deflection is None
    at_other = analyze_vibration(response, housing, "case", speed=61.0, order=2.2, points=("b",))
    assert (at_other.at_speed, at_other.at_order) == (0, 1)
    assert at_other.bearings.point.shape == (1, 4)
    with pytest.raises(InputError, match="surface or named points"):
        analyze_vibration(response, replace(housing, points=()), "case")
