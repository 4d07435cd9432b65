"""Scatter, tolerances of ISO 1328-1:2013 (formulas 7 and 10, by hand) and loads with a misalignment each."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from spur_gears import PAIR

from fe_contact import AnalysisOptions, Gear, GearPair, Run, Scatter, analyze
from fe_contact.errors import InputError
from fe_contact.geometry.flank_tolerances import helix_slope_tolerance, profile_slope_tolerance, rounded
from fe_contact.microgeometry.design_loads import DesignLoads, misalignment_axis, snapped_to_axis
from fe_contact.microgeometry.design_study import DesignSpace, design_study
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.scatter import GaussHermite, SobolSample
from fe_contact.microgeometry.tolerances import iso1328_tolerances
from fe_contact.microgeometry.variables import modified
from model_studies.stage_clock import StageClock

SLOPE, CROWNING = "pinion.profile_slope", "wheel.profile_crowning"


def evaluator(pair: GearPair, scatter: Scatter, model: str, varied: tuple[str, ...] = ()) -> Evaluator:
    options = AnalysisOptions(level="draft", model=model)
    space = DesignSpace(pair, dict.fromkeys(varied, 1e-6), scatter, 0.0, 16, options)
    return design_study(space, [200.0], [], StageClock(), Run()).evaluator


@pytest.mark.parametrize("points", [1, 2, 5])
def test_gauss_hermite_is_exact_to_its_degree(points):
    place, weight = GaussHermite(points).nodes(1)
    for degree in range(0, 2 * points, 2):
        exact = math.prod(range(degree - 1, 0, -2))
        assert weight @ place[:, 0] ** degree == pytest.approx(exact, rel=1e-12)
        assert abs(weight @ place[:, 0] ** (degree + 1)) < 1e-12 * max(exact, 1)


def test_nodes_and_samples_have_the_moments_of_the_scatter():
    nodes = Scatter(1e-5, {CROWNING: 2e-6, SLOPE: 4e-6}, GaussHermite(3)).nodes()
    assert nodes.names == ("misalignment", SLOPE, CROWNING)
    assert nodes.weight.sum() == pytest.approx(1.0, rel=1e-14)
    np.testing.assert_allclose(nodes.weight @ nodes.deviation**2, [1e-10, 16e-12, 4e-12], rtol=1e-12)
    covariance = (nodes.weight[:, None] * nodes.deviation).T @ nodes.deviation
    assert np.abs(covariance - np.diag(np.diag(covariance))).max() < 1e-24
    assert nodes.modification(0) == {SLOPE: nodes.deviation[0, 1], CROWNING: nodes.deviation[0, 2]}
    rule = SobolSample(5, seed=3)
    place, weight = rule.nodes(3)
    np.testing.assert_array_equal(place, rule.nodes(3)[0])
    np.testing.assert_array_equal(place, rule.finer(3).nodes(3)[0][:32])
    assert np.abs(weight @ place).max() < 0.1
    np.testing.assert_allclose(weight @ place**2, 1.0, rtol=0.2)
    assert not np.array_equal(place, SobolSample(5, seed=4).nodes(3)[0])
    nodes = Scatter().nodes()
    assert nodes.names == () and nodes.weight.tolist() == [1.0] and nodes.finer is None


@pytest.mark.parametrize(("points", "dimensions"), [(5, 1), (5, 3), (5, 4), (4, 5), (1, 11)])
def test_every_rule_has_one_to_tell_its_error_by(points, dimensions):
    rule = GaussHermite(points)
    place, weight = rule.finer(dimensions).nodes(dimensions)
    assert place.shape == (weight.size, dimensions) and weight.size <= 1024
    assert weight.size != rule.nodes(dimensions)[1].size


def test_every_node_is_the_pair_as_it_comes_out():
    """Two deviations at once, against whole tables of pairs made so; crowning does not become negative."""
    assessed = evaluator(PAIR, Scatter(0.0, {SLOPE: 5e-6, CROWNING: 3e-6}, GaussHermite(2)), "plane_strain")
    found = assessed.evaluate({CROWNING: 2e-6})
    for node, (slope, crowning) in enumerate(assessed.nodes.deviation):
        made = modified(PAIR, {SLOPE: slope, CROWNING: max(0.0, 2e-6 + crowning)})
        table = analyze(
            made, torques=[200.0], positions=16, model="plane_strain", level="draft", receipt="minimal",
        )  # fmt: skip
        np.testing.assert_array_equal(found.ste[node, :, 0], table.static_transmission_error[:, 0, 0, 0])
        assert found.pressure[node, 0] == pytest.approx(table.max_pressure.max(), rel=1e-12, abs=0.0)
    assert assessed.expected(found)[0] == pytest.approx(found.peak_to_peak.mean(), rel=1e-12, abs=0.0)


def test_a_symmetric_pair_is_as_loud_misaligned_either_way():
    assessed = evaluator(PAIR, Scatter(20e-6, rule=GaussHermite(3)), "3d", ("pinion.helix_crowning",))
    plain = assessed.evaluate({})
    left, aligned, right = plain.peak_to_peak[:, 0]
    assert left == pytest.approx(right, rel=1e-6, abs=0.0)
    factor = plain.face_load_factor[:, 0]
    assert factor[0] == pytest.approx(factor[2], rel=1e-6, abs=0.0)
    assert factor[0] > 1.5 * factor[1]
    # crowned flanks bear nearer to the middle when misaligned, and less evenly when aligned
    crowned = assessed.evaluate({"pinion.helix_crowning": 10e-6}).face_load_factor[:, 0]
    assert crowned[0] < factor[0] and crowned[1] > factor[1]
    assert aligned > 0.0


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
def test_tolerances_are_those_of_the_formulas(gear, tolerance_class, profile_um, helix_um):
    assert 1e6 * profile_slope_tolerance(gear, tolerance_class) == pytest.approx(profile_um, rel=1e-12)
    assert 1e6 * helix_slope_tolerance(gear, tolerance_class) == pytest.approx(helix_um, rel=1e-12)


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
def test_rounding_is_to_tenths_halves_and_whole_micrometers(exact, told):
    assert rounded(exact) == told


def test_a_tolerance_grows_with_every_class_and_what_it_is_of():
    gear = gear_of(4, 20, 25)
    for tolerance in (profile_slope_tolerance, helix_slope_tolerance):
        widths = [tolerance(gear, grade) for grade in range(1, 12)]
        assert all(1.3 < b / a < 1.55 for a, b in pairwise(widths))
    assert profile_slope_tolerance(replace(gear, face_width=0.4), 7) == profile_slope_tolerance(gear, 7)
    assert helix_slope_tolerance(replace(gear, face_width=0.4), 7) > helix_slope_tolerance(gear, 7)
    pair = GearPair(gear_of(4, 20, 25), gear_of(4, 60, 25), 160e-3)
    all_of = iso1328_tolerances(pair, 7, misalignment=20e-6)
    assert all_of.misalignment == 20e-6
    assert all_of.modification["wheel.helix_slope"] == helix_slope_tolerance(pair.wheel, 7)
    assert all_of.modification["pinion.profile_slope"] == profile_slope_tolerance(pair.pinion, 7)
    flat = iso1328_tolerances(pair, 7, across_face=False).modification
    profiles = {f"{gear}.profile_{kind}" for gear in ("pinion", "wheel") for kind in ("slope", "form")}
    assert set(flat) == profiles
    hobbed = iso1328_tolerances(pair, 7, finishing="hobbing").modification
    assert hobbed["wheel.helix_form"] == 0.6 * all_of.modification["wheel.helix_form"]


@pytest.mark.parametrize(
    ("gear", "field"),
    [
        (gear_of(4, 20, 3), "pinion.face_width"),
        (gear_of(0.4, 20, 10), "pinion.normal_module"),
        (gear_of(4, 20, 25, 46), "pinion.helix_angle"),
    ],
)
def test_beyond_its_range_the_standard_has_no_tolerance(gear, field):
    mate = replace(gear, helix_angle=-gear.helix_angle)
    pair = GearPair(gear, mate, 2.0 * gear.reference_radius)
    with pytest.raises(InputError, match="give your own figures") as caught:
        iso1328_tolerances(pair, 6)
    assert caught.value.field == field
    with pytest.raises(InputError):
        iso1328_tolerances(pair, 12)


LOADS = [100.0, 200.0, 200.0, 400.0]
SKEWS = [4e-6, 8e-6, -2e-6, 20e-6]


def test_misalignments_are_of_every_load_and_between_those_of_neighbors():
    for one in (8e-6, [8e-6], np.array(8e-6)):
        assert DesignLoads.of([100.0, 300.0], one).misalignment.tolist() == [8e-6, 8e-6]
    loads, own = DesignLoads.of(LOADS, SKEWS).with_torques([50.0, 150.0, 200.0, 300.0, 500.0])
    assert loads.torque.tolist() == [50.0, 100.0, 150.0, 200.0, 200.0, 300.0, 400.0, 500.0]
    expected = [4e-6, 4e-6, 6e-6, 8e-6, -2e-6, 9e-6, 20e-6, 20e-6]
    np.testing.assert_allclose(loads.misalignment, expected, rtol=1e-12)
    assert own.tolist() == [1, 3, 4, 6]
    again, _ = DesignLoads.of(LOADS, SKEWS).with_torques(loads.torque)
    np.testing.assert_array_equal(again.misalignment, loads.misalignment)


def test_a_table_has_every_misalignment_once():
    """A sum and the number it should be differ in the last bit: an axis through both would have no slope."""
    skews, away = np.array([4.1e-6, 12.3e-6]), np.array([8.2e-6, -8.2e-6])
    assert skews[0] + away[0] != skews[1]
    axis = misalignment_axis(skews, away)
    np.testing.assert_allclose(axis, [-4.1e-6, 4.1e-6, 12.3e-6, 20.5e-6], rtol=1e-12)
    assert set(snapped_to_axis(axis, skews + away[:, None]).ravel()) <= set(axis)
    assert snapped_to_axis(axis, np.array([[5e-6]])) == 5e-6  # between two of them
