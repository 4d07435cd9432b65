"""Element passing: order as published, size zero where all elements carry alike, closed form with few."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dynamics.bearings import BallBearing, RollerBearing
from dynamics.bearings.loaded_bearing import LoadedBearing, element_passing

# Case Western Reserve University, Bearing Data Center, drive end: SKF 6205, outer ring 3.5848 per revolution
SKF_6205 = BallBearing(9, 0.3126 * 25.4e-3, 1.537 * 25.4e-3)
ROLLERS = RollerBearing(count=14, diameter=9e-3, length=13.6e-3, pitch_diameter=53.5e-3)
RADIAL = (1000.0, 0.0, 0.0, 0.0, 0.0)


def test_elements_pass_as_often_as_published():
    assert element_passing(SKF_6205, RADIAL, angles=2).order == pytest.approx(3.5848, rel=1e-4)


def test_a_thrust_load_feels_no_passing():
    passing = element_passing(SKF_6205, (0.0, 0.0, 1000.0, 0.0, 0.0))
    assert passing.peak_to_peak[[0, 1, 2]].max() < 1e-9 * passing.displacement[:, 2].mean()


def test_one_or_two_loaded_balls_are_closed_forms():
    # three balls: at angle 0 one carries all, a sixth of a turn on two carry it at 60 degrees
    three = replace(SKF_6205, count=3)
    passing = element_passing(three, RADIAL, angles=2)
    one = (1000.0 / three.element_stiffness) ** (2.0 / 3.0)
    half = math.cos(math.pi / 3.0)
    two = (1000.0 / (2.0 * half * three.element_stiffness)) ** (2.0 / 3.0) / half
    assert passing.displacement[:, 0] == pytest.approx([one, two], rel=1e-9)
    assert passing.peak_to_peak[0] == pytest.approx(two - one, rel=1e-9)


@pytest.mark.parametrize("bearing", [SKF_6205, ROLLERS], ids=["balls", "rollers"])
def test_the_motion_is_about_that_of_averaged_elements(bearing):
    passing = element_passing(bearing, RADIAL)
    averaged = LoadedBearing(bearing, copies=50).displacement(RADIAL)[0]
    assert 1e-3 < passing.peak_to_peak[0] / averaged < 0.1
    assert passing.displacement[:, 0].mean() == pytest.approx(averaged, rel=1e-2)
    # a mirrored cage mirrors the motion
    assert passing.displacement[1:, 1] == pytest.approx(-passing.displacement[:0:-1, 1], abs=1e-12)
    assert np.abs(passing.displacement[:, 1]).max() > 1e-9
