"""Sound of several housings under one response: powers add up, errors of levels do not."""

import numpy as np
import pytest
from sounding_scene import housing, response

from dynamics.noise import Radiation, SurfaceHousing, radiated_sound, scene_sound

NAMES = ("case", "cover")
ESTIMATE = Radiation(boundary_elements=False)


def surfaces(*names):
    bearings = tuple(seat.name for seat in housing().seats)
    return [SurfaceHousing(name, housing(), bearings) for name in names]


@pytest.fixture(scope="module")
def single():
    return scene_sound(response(), surfaces("case"), ESTIMATE)


@pytest.fixture(scope="module")
def double():
    return scene_sound(response(), surfaces(*NAMES), ESTIMATE)


@pytest.mark.law
def test_two_equal_housings_are_3_db_louder_and_as_uncertain_as_one(single, double):
    np.testing.assert_allclose(double.power.power, 2.0 * single.power.power, rtol=1e-12)
    np.testing.assert_allclose(double.error, single.error, atol=1e-9)
    assert np.all(single.error[0] < 0.0) and np.all(single.error[1] > 0.0)


def test_the_sound_of_one_housing_is_its_radiated_sound(single):
    (own,) = single.housings
    alone = radiated_sound(response(), own.body, own.bearings, own.radiation, own.name)
    np.testing.assert_array_equal(single.power.power, alone.power)


def test_regions_of_a_loud_point_hold_all_of_its_power(double):
    for regions in double.regions:
        assert sum(region.share for region in regions) == pytest.approx(1.0, rel=1e-9)
        assert {region.housing for region in regions} == set(NAMES)


def test_the_finest_model_is_that_of_the_result(single):
    levels = single.models["case"]
    assert list(levels.level)[-1] == "estimate" and levels.error["estimate"] == 0.0
    assert list(levels.error_band) == list(levels.predicted)
