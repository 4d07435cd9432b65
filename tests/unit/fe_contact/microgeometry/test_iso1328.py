"""Slope tolerances of ISO 1328-1:2013, clause 5: formulas (7) and (10), step, rounding, range.

The edition has formulas and no tables. The figures are worked by hand from the formulas as three independent
programs have them, which give their numbers and those of the clauses (of ISO 1328-1:2013, of ANSI/AGMA ISO
1328-1-B14, and of DIN ISO 1328-1:2018).
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import pytest

from fe_contact import Gear, GearPair
from fe_contact.errors import InputError
from fe_contact.microgeometry.tolerance_study import (
    _helix_slope_tolerance,
    _profile_slope_tolerance,
    _rounded,
    iso1328_tolerances,
)


def gear_of(module_mm: float, teeth: int, width_mm: float, helix_deg: float = 0.0) -> Gear:
    bore = 0.5e-3 * module_mm * teeth
    return Gear(teeth, 1e-3 * module_mm, 1e-3 * width_mm, bore, helix_angle=math.radians(helix_deg))


@pytest.mark.parametrize(
    ("gear", "tolerance_class", "profile_um", "helix_um"),
    [
        # class 5, unrounded: 1.6 + 0.08 + 4 = 5.68 and 0.4472 + 1.75 + 4 = 6.1972
        (gear_of(4, 20, 25), 5, 5.5, 6.0),
        (gear_of(4, 20, 25), 3, 2.8, 3.1),
        (gear_of(4, 20, 25), 6, 8.0, 9.0),
        (gear_of(4, 20, 25), 8, 16.0, 18.0),
        (gear_of(4, 20, 25), 9, 23.0, 25.0),  # 22.72: four times the rounded 5.5 would be 22
        # 0.4 + 0.02 + 4 = 4.42 and 0.2236 + 1.1068 + 4 = 5.3304
        (gear_of(1, 20, 10), 5, 4.4, 5.5),
        (gear_of(1, 20, 10), 1, 1.1, 1.3),
        (gear_of(1, 20, 10), 11, 35.0, 43.0),
        # 4 + 1 + 4 = 9 and 1.5811 + 4.9497 + 4 = 10.5309
        (gear_of(10, 100, 200), 5, 9.0, 11.0),
        (gear_of(10, 100, 200), 7, 18.0, 21.0),
        # d = 39 * 3 / cos 26 deg = 130.174: 1.2 + 0.1302 + 4 = 5.3302 and 0.5705 + 1.75 + 4 = 6.3205
        (gear_of(3, 39, 25, 26), 6, 7.5, 9.0),
    ],
)
def test_tolerances_are_those_of_the_formulas(
    gear: Gear, tolerance_class: int, profile_um: float, helix_um: float
) -> None:
    assert 1e6 * _profile_slope_tolerance(gear, tolerance_class) == pytest.approx(profile_um, rel=1e-12)
    assert 1e6 * _helix_slope_tolerance(gear, tolerance_class) == pytest.approx(helix_um, rel=1e-12)


@pytest.mark.parametrize(
    ("exact", "told"),
    [
        (4.94, 4.9),
        (4.96, 5.0),
        (5.24, 5.0),
        (5.25, 5.5),
        (9.74, 9.5),
        (9.8, 10.0),
        (10.4, 10.0),
        (10.5, 11.0),
    ],
)
def test_rounding_is_to_tenths_halves_and_whole_micrometers(exact: float, told: float) -> None:
    assert _rounded(exact) == told


def test_a_tolerance_grows_with_every_class_and_what_it_is_of() -> None:
    gear = gear_of(4, 20, 25)
    for tolerance in (_profile_slope_tolerance, _helix_slope_tolerance):
        widths = [tolerance(gear, grade) for grade in range(1, 12)]
        assert all(1.3 < b / a < 1.55 for a, b in pairwise(widths))
    assert _profile_slope_tolerance(replace(gear, face_width=0.4), 7) == _profile_slope_tolerance(gear, 7)
    assert _helix_slope_tolerance(replace(gear, face_width=0.4), 7) > _helix_slope_tolerance(gear, 7)


def test_both_gears_get_their_own_and_a_plane_has_no_helix() -> None:
    pair = GearPair(gear_of(4, 20, 25), gear_of(4, 60, 25), 160e-3)
    all_of = iso1328_tolerances(pair, 7, misalignment=20e-6)
    assert all_of.misalignment == 20e-6
    assert all_of.modification["wheel.helix_slope"] == _helix_slope_tolerance(pair.wheel, 7)
    assert all_of.modification["pinion.profile_slope"] == _profile_slope_tolerance(pair.pinion, 7)
    flat = iso1328_tolerances(pair, 7, across_face=False).modification
    assert set(flat) == {"pinion.profile_slope", "wheel.profile_slope"}


@pytest.mark.parametrize(
    ("gear", "field"),
    [
        (gear_of(4, 20, 3), "pinion.face_width"),
        (gear_of(0.4, 20, 10), "pinion.normal_module"),
        (gear_of(4, 20, 25, 46), "pinion.helix_angle"),
    ],
)
def test_beyond_its_range_the_standard_has_no_tolerance(gear: Gear, field: str) -> None:
    mate = replace(gear, helix_angle=-gear.helix_angle)
    pair = GearPair(gear, mate, 2.0 * gear.reference_radius)
    with pytest.raises(InputError, match="give your own as Tolerances") as caught:
        iso1328_tolerances(pair, 6)
    assert caught.value.field == field
    with pytest.raises(InputError):
        iso1328_tolerances(pair, 12)
