"""Pitch, run-out and form of ISO 1328-1:2013 (formulas 5, 6, 8 and 11, and annex E), by hand."""

import math
from itertools import pairwise

import pytest

from fe_contact import Gear
from fe_contact.geometry.flank_tolerances import (
    cumulative_pitch_tolerance,
    helix_form_tolerance,
    helix_slope_tolerance,
    helix_tolerance,
    profile_form_tolerance,
    profile_slope_tolerance,
    profile_tolerance,
    run_out_tolerance,
    single_pitch_tolerance,
)

OF_TEETH = single_pitch_tolerance, cumulative_pitch_tolerance, run_out_tolerance
OF_FLANKS = profile_slope_tolerance, profile_form_tolerance, helix_slope_tolerance, helix_form_tolerance
FORMED = (*OF_TEETH, profile_form_tolerance, helix_form_tolerance)


def gear_of(module_mm: float, teeth: int, width_mm: float, helix_deg: float = 0.0) -> Gear:
    bore = 0.5e-3 * module_mm * teeth
    return Gear(teeth, 1e-3 * module_mm, 1e-3 * width_mm, bore, helix_angle=math.radians(helix_deg))


@pytest.mark.parametrize(
    ("gear", "tolerance_class", "micrometers"),
    [
        # class 5, unrounded: 6.68, 19.879, 17.891, 7.2 and 6.876
        (gear_of(4, 20, 25), 5, (6.5, 20.0, 18.0, 7.0, 7.0)),
        # times sqrt 2: 8.938, 28.800, 25.920, 9.405 and 10.227
        (gear_of(3, 40, 30), 6, (9.0, 29.0, 26.0, 9.5, 10.0)),
        # d = 1000: twice 10, 38.393, 34.553, 10.5 and 12.578
        (gear_of(10, 100, 200), 7, (20.0, 77.0, 69.0, 21.0, 25.0)),
        # d = 39 * 3 / cos 26 deg = 130.174: 8.952, 29.183, 26.265, 9.405 and 9.968
        (gear_of(3, 39, 25, 26), 6, (9.0, 29.0, 26.0, 9.5, 10.0)),
        # a quarter of class 5: 1.67, 4.970, 4.473, 1.8 and 1.719
        (gear_of(4, 20, 25), 1, (1.7, 5.0, 4.5, 1.8, 1.7)),
    ],
)
def test_pitch_run_out_and_form_are_those_of_the_formulas(gear, tolerance_class, micrometers):
    found = [1e6 * tolerance(gear, tolerance_class) for tolerance in FORMED]
    assert found == pytest.approx(micrometers, rel=1e-12)


def test_the_whole_profile_has_the_root_of_both_squares():
    """m_n 4, d 80, class 5: slope 1.6 + 0.08 + 4 = 5.68, form 2.2 + 5 = 7.2, in all 9.171: to halves 9.0."""
    assert profile_tolerance(gear_of(4, 20, 25), 5) == pytest.approx(9.0e-6, rel=1e-12)
    # of class 7 twice as much, 18.342: to whole ones
    assert profile_tolerance(gear_of(4, 20, 25), 7) == pytest.approx(18.0e-6, rel=1e-12)


@pytest.mark.parametrize("tolerance", [*OF_TEETH, *OF_FLANKS])
def test_two_classes_double_a_tolerance(tolerance):
    gear = gear_of(4, 20, 25)
    widths = [tolerance(gear, grade) for grade in range(1, 12)]
    assert all(1.3 < b / a < 1.55 for a, b in pairwise(widths))
    assert all(b / a == pytest.approx(2.0, rel=0.06) for a, b in zip(widths, widths[2:], strict=False))


def test_the_whole_helix_is_slope_and_form_by_squares():
    gear = gear_of(10, 100, 200)
    parts = helix_slope_tolerance(gear, 11), helix_form_tolerance(gear, 11)
    assert helix_tolerance(gear, 11) == pytest.approx(math.hypot(*parts), rel=0.01)
    assert run_out_tolerance(gear, 11) == pytest.approx(0.9 * cumulative_pitch_tolerance(gear, 11), rel=0.01)
