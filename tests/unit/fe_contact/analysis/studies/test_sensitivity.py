"""Sensitivity studies: the same figures as single tables, and the change that follows from them."""

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import Gear, GearPair, analyze, study_sensitivity
from fe_contact.analysis.studies.sensitivity import RippleCurve
from fe_contact.errors import InputError
from fe_contact.options import Run

FORCE = 2000.0


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


@pytest.fixture(scope="module")
def pair():
    gear = Gear(
        teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3, thickness_allowance=60e-6
    )
    return GearPair(gear, gear, 80e-3)


def study(pair, cache, **options):
    options = {"misalignments": [30e-6], "center_distance_changes": [-50e-6, 80e-6]} | options
    return study_sensitivity(
        pair,
        *table_request(normal_forces=[FORCE], level="draft", positions=16, **options),
        run=Run(cache=cache),
    )


@pytest.fixture(scope="module")
def plain(pair, cache):
    return study(pair, cache)


@pytest.mark.parametrize("corners", [False, True])
def test_the_curves_are_those_of_tables(pair, cache, plain, corners):
    found = plain[corners]
    assert found.corner_contact is corners
    effects = {"corner_contact": "on" if corners else "off"}
    options = {"level": "draft", "positions": 16, "model": "3d", "effects": effects, "cache": cache}
    skewed = analyze(pair, normal_forces=[FORCE], misalignments=[30e-6], **options).peak_to_peak(force=FORCE)
    wide = analyze(pair, normal_forces=[FORCE], center_distance_changes=[80e-6], **options)
    apart = wide.peak_to_peak(force=FORCE, center_distance_change=80e-6)
    assert found.misalignment.peak_to_peak[-1] == pytest.approx(skewed.value, rel=1e-9, abs=0.0)
    assert found.center_distance_change.peak_to_peak[-1] == pytest.approx(apart.value, rel=1e-9, abs=0.0)
    # the worst interpolation of the assessed operating points stands for all of them
    assert found.center_distance_change.error[-1] >= apart.error * (1.0 - 1e-6)


def test_both_curves_pass_through_the_nominal_pair(plain):
    for found in plain:
        skew, distance = found.misalignment, found.center_distance_change
        assert skew.deviation == pytest.approx([0.0, 30e-6])
        assert distance.deviation == pytest.approx([-50e-6, 0.0, 80e-6])
        assert distance.peak_to_peak[1] == pytest.approx(skew.peak_to_peak[0], rel=1e-9, abs=0.0)
        assert skew.relative_change[0] == 0.0
        assert distance.relative_change[1] == 0.0


def test_a_case_may_choose_other_effects(pair, cache, plain):
    loose, _ = study(pair, cache, effects={"tooth_coupling": "off", "corner_contact": "on"})
    assert loose.corner_contact is False
    assert loose.misalignment.peak_to_peak[0] > 1.05 * plain[0].misalignment.peak_to_peak[0]


def test_the_change_is_against_the_value_without_deviation():
    curve = RippleCurve(np.array([-1e-5, 0.0, 2e-5]), np.array([3e-6, 2e-6, 8e-6]), np.zeros(3))
    assert curve.relative_change == pytest.approx([0.5, 0.0, 3.0])


def test_a_plane_model_cannot_be_misaligned(pair, cache):
    with pytest.raises(InputError) as caught:
        study(pair, cache, model="plane_strain")
    assert caught.value.field == "misalignments"


def test_a_distance_at_which_the_teeth_jam_is_named(pair, cache):
    with pytest.raises(InputError, match="teeth jam") as caught:
        study(pair, cache, center_distance_changes=[-2e-3])
    assert caught.value.field == "center_distance_changes[0]"
