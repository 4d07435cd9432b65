"""Misalignment that a class allows: by hand from the formulas of the standards, and how sources add up."""

import math
from dataclasses import replace

import pytest

from fe_contact.errors import InputError
from fe_contact.geometry import Gear, GearPair, Shaft
from fe_contact.geometry.flank_tolerances import helix_tolerance, misalignment_range, rounded


def pair(
    helix_deg: float = 0.0, width: float = 20e-3, wheel_width: float = 20e-3, span: float = 0.0
) -> GearPair:
    helix = math.radians(helix_deg)
    first = Gear(25, 3e-3, width, 20e-3, helix_angle=helix)
    second = Gear(50, 3e-3, wheel_width, 30e-3, helix_angle=-helix)
    shafts = (Shaft(span, 25e-3, 0.5 * span), None) if span else (None, None)
    return GearPair(first, second, center_distance=112.5e-3 / math.cos(helix), shafts=shafts)


def test_class_seven_of_a_spur_pair_is_that_of_the_formulas_by_hand():
    """d 75 and 150 mm, b 20 mm, 20 degrees.

    f_Hbeta of class 5: 0.05 * 8.6603 + 0.35 * 4.4721 + 4 = 5.998 and 6.178 um; twice, rounded: 12 and 12.
    f_fbeta: 0.07 * 8.6603 + 0.45 * 4.4721 + 4 = 6.619 and 6.870; F_beta: 8.932 and 9.239; twice: 18 and 18.
    18 sin 20 = 6.156, 9 cos 20 = 8.457; the root of 37.90 + 71.53 + 144 + 144 is 19.94.
    """
    made = misalignment_range(pair(), 7)
    expected = {
        "axes in their plane": 6.156,
        "axes out of their plane": 8.457,
        "helix slope of the pinion": 12.0,
        "helix slope of the wheel": 12.0,
    }
    assert {name: 1e6 * value for name, value in made.by_source.items()} == pytest.approx(expected, abs=1e-3)
    assert 1e6 * made.likely == pytest.approx(19.94, abs=0.01)
    assert 1e6 * made.worst == pytest.approx(38.61, abs=0.01)
    assert [1e6 * value for value in made.axis] == pytest.approx([-20.0, -10.0, 0.0, 10.0, 20.0])
    assert "to 20 µm" in made.text and "19.9 µm by squares, 38.6 µm at worst" in made.text


def test_the_axis_ends_at_a_figure_of_the_standard():
    for tolerance_class in (1, 3, 5, 9):
        made = misalignment_range(pair(), tolerance_class)
        assert 1e6 * made.axis[-1] == pytest.approx(rounded(1e6 * made.likely))
        assert (
            made.axis == tuple(sorted(made.axis)) and made.axis[0] == -made.axis[-1] and made.axis[2] == 0.0
        )


@pytest.mark.parametrize(("tolerance_class", "helix_um"), [(5, 9.0), (6, 13.0), (7, 18.0), (9, 36.0)])
def test_the_whole_helix_is_rounded_once(tolerance_class, helix_um):
    """8.932 µm of class 5, times the root of two to the classes above, then rounded (5.2.2, 5.2.3)."""
    assert 1e6 * helix_tolerance(pair().pinion, tolerance_class) == pytest.approx(helix_um)


def test_a_gear_wider_than_the_common_face_opens_it_by_its_part():
    """b 25 mm: f_Hbeta of 0.05 * 12.2474 + 0.35 * 5 + 4 = 6.362, twice and rounded 13 µm, 20/25 of it."""
    made = misalignment_range(pair(wheel_width=25e-3), 7)
    assert 1e6 * made.by_source["helix slope of the wheel"] == pytest.approx(10.4)


def test_a_larger_pressure_angle_moves_weight_into_the_plane_of_the_axes():
    made = misalignment_range(pair(helix_deg=30.0), 7)
    ratio = made.by_source["axes in their plane"] / made.by_source["axes out of their plane"]
    assert ratio == pytest.approx(2.0 * math.tan(math.radians(20.0)) / math.cos(math.radians(30.0)))


def test_a_clearance_tilts_its_shaft_over_the_span_of_its_bearings():
    made = misalignment_range(pair(span=0.1), 7, (25e-6, 0.0))
    assert 1e6 * made.by_source["bearing clearance of the pinion"] == pytest.approx(5.0)
    assert 1e6 * made.likely == pytest.approx(math.hypot(19.936, 5.0), abs=0.01)
    with pytest.raises(InputError, match="without the shaft of the wheel"):
        misalignment_range(pair(span=0.1), 7, (25e-6, 25e-6))


def test_a_finer_class_never_allows_more_and_others_are_refused():
    likely = [misalignment_range(pair(), number).likely for number in range(1, 12)]
    assert likely == sorted(likely)
    for number in (0, 12):
        with pytest.raises(InputError, match="tolerance_class"):
            misalignment_range(pair(), number)
    with pytest.raises(InputError, match="face_width"):
        misalignment_range(replace(pair(), wheel=replace(pair().wheel, face_width=2e-3)), 7)
