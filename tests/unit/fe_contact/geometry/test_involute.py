from __future__ import annotations

import math

import numpy as np
import pytest

from fe_contact.flank.involute import (
    inverse_involute,
    involute_function,
    involute_normal,
    involute_point,
    roll_length_at_radius,
)


def test_involute_function_of_20_degrees_is_the_tabulated_one() -> None:
    assert involute_function(math.radians(20.0)) == pytest.approx(0.014904384, abs=5e-10)


@pytest.mark.parametrize("degrees", [1e-3, 0.5, 5.0, 20.0, 45.0, 70.0, 89.0])
def test_inverse_involute_undoes_the_involute_function(degrees: float) -> None:
    angle = math.radians(degrees)
    # tan(a) - a loses a^2/3 of its digits at small angles
    assert inverse_involute(involute_function(angle)) == pytest.approx(angle, rel=1e-14 + 1e-15 / angle**2)


def test_inverse_involute_of_zero_is_zero_and_negative_is_refused() -> None:
    assert inverse_involute(0.0) == 0.0
    with pytest.raises(ValueError, match="involute function"):
        inverse_involute(-1e-9)


def test_roll_length_and_radius_are_inverse() -> None:
    base = 0.0375877
    for roll in (0.0, 1e-4, 0.0137, 0.03):
        assert roll_length_at_radius(base, math.hypot(base, roll)) == pytest.approx(roll, abs=1e-12)


def test_point_is_one_roll_length_along_its_normal_from_the_base_circle() -> None:
    base, half, roll = 0.04, 0.1, np.linspace(0.0, 0.03, 7)
    foot = involute_point(base, half, roll) - roll[:, None] * involute_normal(base, half, roll)
    assert np.hypot(*foot.T) == pytest.approx(np.full(7, base), rel=1e-14)
    # the string unwound from the base circle is as long as the arc it covered
    assert base * (half - np.arctan2(foot[:, 0], foot[:, 1])) == pytest.approx(roll, abs=1e-15)


def test_normal_is_unit_and_perpendicular_to_the_curve() -> None:
    base, half, roll, step = 0.04, 0.1, np.linspace(0.001, 0.03, 9), 1e-7
    normal = involute_normal(base, half, roll)
    tangent = involute_point(base, half, roll + step) - involute_point(base, half, roll - step)
    assert np.hypot(*normal.T) == pytest.approx(np.ones(9), rel=1e-15)
    assert np.sum(normal * tangent, axis=1) / np.hypot(*tangent.T) == pytest.approx(np.zeros(9), abs=1e-7)
