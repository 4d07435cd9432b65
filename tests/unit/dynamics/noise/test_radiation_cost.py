"""Cost of a radiation resistance over a range: predicted before, in the result after, growing as it does."""

import math
from functools import cache

import numpy as np
import pytest
from hulls import box
from reduced_housings import bare_housing
from sounding_housings import smooth_motion, with_surface

from dynamics.acoustics import Air, ElementalRadiators, outer_hull
from dynamics.housings import ReducedHousing
from dynamics.noise import HousingRadiation, housing_radiation, radiating_hull
from dynamics.noise.housing_radiation import USUAL, Octave, expected_knots, octave_ranges, radiation_cost
from dynamics.work_cost import Cost

AIR, MODEL = Air(), ElementalRadiators()
TOLD: list[Cost] = []


@cache
def body(divisions: int = 6) -> ReducedHousing:
    bare = bare_housing(modal=20)
    hull = box((0.3, 0.2, 0.15), (divisions, divisions - 2, divisions - 3))
    return with_surface(bare, hull, smooth_motion(hull, len(bare.stiffness)))


@cache
def radiation() -> HousingRadiation:
    return housing_radiation(body(), MODEL, [100.0, 1200.0], expected=TOLD.append)


def predicted(low: float, high: float, divisions: int = 6) -> Cost:
    outer = outer_hull(body(divisions))
    parted = [
        Octave(*ends, radiating_hull(outer, ends[1], AIR.sound_speed)) for ends in octave_ranges(low, high)
    ]
    return radiation_cost(parted, MODEL, AIR)


def test_it_grows_with_the_range_and_with_panels():
    octave, two, maximum = predicted(200.0, 400.0), predicted(200.0, 800.0), predicted(100.0, 1200.0)
    assert octave.seconds < two.seconds < maximum.seconds
    assert octave.seconds < predicted(400.0, 800.0).seconds
    coarse, fine = predicted(200.0, 800.0), predicted(200.0, 800.0, 12)
    assert coarse.seconds < fine.seconds and coarse.bytes < fine.bytes


def test_an_octave_costs_that_of_its_frequencies_and_octaves_add_up():
    hull = radiating_hull(outer_hull(body()), 800.0, AIR.sound_speed)
    top = 2.0 * math.pi * 800.0 / AIR.sound_speed * hull.hull.outer_radius
    each = MODEL.cost(len(hull.shapes), USUAL * top, hull.shapes.shape[1])
    upper = predicted(400.0, 800.0)
    assert upper.seconds == pytest.approx(each.seconds * expected_knots(top))
    assert predicted(200.0, 800.0).seconds == pytest.approx(predicted(200.0, 400.0).seconds + upper.seconds)


def test_it_is_told_before_and_kept_with_the_result():
    cost = radiation().metadata.cost
    assert [tuple(each) for each in TOLD] == [(cost.predicted_seconds, cost.predicted_bytes)]
    assert cost.seconds > 0.0


def test_frequencies_are_about_as_many_as_expected():
    """Between half as many, of simple modes as these, and a quarter more."""
    frequency, outer = radiation().frequency, outer_hull(body())
    ends = octave_ranges(float(frequency[0]), float(frequency[-1]))
    per_hertz = 2.0 * math.pi / AIR.sound_speed * outer.hull.outer_radius
    expected = sum(expected_knots(per_hertz * last) for _, last in ends)
    assert 0.5 < frequency.size / expected < 1.25
    assert np.all(np.diff(frequency) > 0.0)
