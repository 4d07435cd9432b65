"""Which model and mesh an accuracy asks for: the cheapest that promises it, unless chosen explicitly."""

import dataclasses
import math
from dataclasses import replace

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import FlankModification, Gear, GearPair, Material, analyze
from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.request.expected_curves import expected_curves
from fe_contact.analysis.request.model_choice import alternative_requests, decide
from fe_contact.analysis.request.request_check import check_request
from fe_contact.geometry.finite_width import finite_width_excess
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.ste.curve_errors import SOURCES

LOADS = [400.0, 1600.0]


def pair(helix: float = 0.0, width: float = 16e-3, **modification: float) -> GearPair:
    gear = Gear(20, 2e-3, width, 20e-3, helix_angle=helix, modification=FlankModification(**modification))
    mate = dataclasses.replace(gear, helix_angle=-helix, modification=FlankModification())
    return GearPair(gear, mate, 40e-3 / math.cos(helix))


def replace_materials(pair: GearPair, material: Material) -> GearPair:
    gears = (dataclasses.replace(gear, material=material) for gear in (pair.pinion, pair.wheel))
    return GearPair(*gears, pair.center_distance)


def decision(pair: GearPair, **asked):
    return decide(check_request(pair, *table_request(normal_forces=LOADS, **asked)))


def model_of(found) -> str:
    return found.to_json()["model"]


def test_a_looser_tolerance_never_takes_more_work():
    """Down to plane strain, where what it leaves out is within the tolerance."""
    for case in (pair(), pair(0.3), pair(width=3e-3)):
        found = [decision(case, tolerance=t) for t in (0.2, 0.05, 0.02, 0.01, 0.005, 0.002)]
        effort = [one.mesh.option.effort for one in found if one.mesh.met]
        assert effort == sorted(effort)
        assert all(one.mesh.option.error.total <= t for one, t in zip(found, (0.2, 0.05), strict=False))
    assert model_of(decision(pair(), tolerance=0.05)) == "plane strain"
    assert model_of(decision(pair(), tolerance=0.01)) == "plane strain corrected for the finite width"


def test_three_dimensions_are_taken_where_the_correction_is_not_enough():
    """Of usual steel the correction errs by less than the finest mesh of three dimensions does."""
    soft = Material(youngs_modulus=206e9, poissons_ratio=0.45)
    plain = pair(width=2e-3)
    narrow = replace_materials(plain, soft)
    assert 0.03 * finite_width_excess(narrow)[0] > 0.0035 > 0.03 * finite_width_excess(plain)[0]
    assert model_of(decision(plain, tolerance=0.0035)) == "plane strain corrected for the finite width"
    found = decision(narrow, tolerance=0.0035)
    assert model_of(found) == "three dimensions"
    entry = next(e for e in found.checked.ledger if e.name == "face_load_distribution")
    assert entry.on
    assert entry.choice == "auto"
    assert "taken for the requested accuracy: expected error" in entry.override


def test_the_ledger_says_why_the_finite_width_is_left_out():
    found = decision(pair(), tolerance=0.05)
    entry = next(e for e in found.checked.ledger if e.name == "finite_width")
    assert (entry.on, entry.choice, entry.verdict.on) == (False, "auto", True)
    assert "left out for the requested accuracy: expected error" in entry.override


@pytest.mark.parametrize(
    "explicit",
    [
        {"model": "plane_strain"},
        {"model": "3d"},
        {"effects": {"finite_width": "on"}},
        {"effects": {"finite_width": "off"}},
        {"effects": {"face_load_distribution": "on"}},
    ],
)
def test_an_explicit_model_or_effect_is_obeyed(explicit):
    asked = check_request(pair(), *table_request(normal_forces=LOADS, tolerance=0.05, **explicit))
    found = decide(asked)
    assert found.checked.model == asked.model
    assert found.checked.ledger == asked.ledger


def test_a_level_or_nothing_asked_keeps_the_model_of_the_scene():
    for asked in ({"level": "draft"}, {}):
        (only,) = alternative_requests(check_request(pair(), *table_request(normal_forces=LOADS, **asked)))
        assert only.model.finite_width
    (only,) = alternative_requests(
        check_request(pair(0.3), TableAxes(normal_forces=LOADS), AnalysisOptions(tolerance=AllowedError(0.1)))
    )
    assert only.model.across_face


def test_helical_pairs_get_the_cheapest_mesh_and_slices_that_are_exact_enough():
    found = [decision(pair(0.3), tolerance=t) for t in (0.1, 0.01)]
    assert found[0].mesh.level == "draft"
    assert found[1].mesh.option.error.total < 0.01 < found[0].mesh.option.error.total
    assert found[1].plan.discretization.slices == found[1].mesh.slices


def test_a_small_ripple_asks_for_more():
    """Steep and wide: the contact lines hardly change their length, so that per cents of ripple are small."""
    smooth = pair(math.radians(30.0), width=math.pi * 2e-3 / math.sin(math.radians(30.0)))
    curves = [
        expected_curves(check_request(one, TableAxes(normal_forces=LOADS))) for one in (pair(0.15), smooth)
    ]
    parts = [(one.peak_to_peak / one.mean).min() for one in curves]
    assert parts[1] < 0.3 * parts[0]
    efforts = [decision(one, tolerance=0.02).mesh.option.effort for one in (pair(0.15), smooth)]
    assert efforts[1] > 1.5 * efforts[0]


def test_the_choice_knows_neither_host_nor_cache(tmp_path, monkeypatch):
    before = decision(pair(0.3), tolerance=0.01).to_json()
    monkeypatch.setattr("fe_contact.planning.cost_model.host_slowness", lambda _: 40.0)
    asked = check_request(pair(0.3), *table_request(normal_forces=LOADS, tolerance=AllowedError(0.01)))
    assert decide(asked, tmp_path).to_json() == before


def test_a_plane_states_what_it_leaves_out_whoever_chose_it():
    """A tolerance or the caller by name: with its bias a plane covers gears of finite width."""
    found = analyze(pair(), normal_forces=LOADS, tolerance=0.05, positions=32)
    named = analyze(pair(), normal_forces=LOADS, model="plane_strain", level="draft", positions=32)
    truth = analyze(pair(), normal_forces=LOADS, level="draft", positions=32)
    assert found.metadata.receipt["choice"]["model"] == "plane strain"
    stress = analyze(pair(), normal_forces=LOADS, model="plane_stress", level="draft", positions=32)
    planes = found, named, stress
    for name in ("mean", "peak_to_peak"):
        one, plain, thin = (getattr(table.curve(force=LOADS[0]).over_face, name) for table in planes)
        exact = getattr(truth, name)(force=LOADS[0])
        assert one == plain
        assert abs(one.value - exact.value) < one.error < 0.01 * one.value
        assert abs(thin.value - exact.value) < thin.error < 0.02 * thin.value
        assert exact.error < one.error
    row = SOURCES.index("finite_width")
    assert np.all(found.curve_error[row, :2] == 0.0)  # a bias stands in no error
    assert np.array_equal(named.curve_error[row], found.curve_error[row])


GEAR = Gear(teeth=25, normal_module=3e-3, face_width=18e-3, bore_diameter=37.5e-3)
WHEEL = replace(GEAR, teeth=31, bore_diameter=46.5e-3)
CROWNED = replace(GEAR, modification=FlankModification(profile_crowning=8e-6))
RATED = [2700.0]


def finite_width(pinion: Gear, tolerance: float) -> bool:
    asked = check_request(
        GearPair(pinion, WHEEL),
        *table_request(normal_forces=RATED, tolerance=AllowedError.from_value(tolerance)),
    )
    return decide(asked).checked.model.finite_width


def test_a_ripple_made_small_by_crowning_keeps_the_finite_width():
    """Without it peak-to-peak of the crowned pair is 6.9 % off at the rated load, of the plain one 3 %."""
    assert not finite_width(GEAR, 0.05)
    assert finite_width(CROWNED, 0.05)
    assert not finite_width(CROWNED, 0.2)
