"""Effects toggled one by one and deviations varied: the figures of single tables, and what changes."""

import json
from dataclasses import replace

import numpy as np
import pytest
from analysis_requests import table_request
from spur_gears import GEAR

from fe_contact import FlankModification, Gear, GearPair, PitchDeviation, ablate, analyze, study_sensitivity
from fe_contact.analysis.database.compute_database import compute_database
from fe_contact.analysis.pairs import contact_lines
from fe_contact.analysis.studies import ablation
from fe_contact.analysis.studies.ablation import Ablation, predicted_ablation
from fe_contact.analysis.studies.sensitivity import RippleCurve
from fe_contact.errors import InputError
from fe_contact.options import Run, TableAxes
from lineofaction.gearbox.studies.ablate.run import RUN
from model_studies.workers import RunCost, dispatch

RELIEVED = replace(GEAR, modification=FlankModification(tip_relief=15e-6, tip_relief_length=1.2e-3))
PAIR = GearPair(RELIEVED, GEAR)
ONLY = ["tooth_coupling", "corner_contact", "profile_modification", "finite_width", "misalignment"]
ASKED = {"normal_forces": [800.0, 2500.0], "level": "draft", "positions": 64}


@pytest.fixture(scope="module")
def made():
    return ablate(PAIR, *table_request(**ASKED), only=ONLY)


def test_a_prediction_has_the_contact_of_every_table_and_condenses_gears_once(made):
    checked = Ablation.request(PAIR, *table_request(**ASKED))
    whole, alone = (predicted_ablation(checked, only, None) for only in (ONLY, ["tooth_coupling"]))
    assert (len(whole.contacts), len(alone.contacts)) == (1 + len(made.effects), 2)
    assert whole.bodies > alone.bodies == predicted_ablation(checked, ["corner_contact"], None).bodies


def test_a_change_is_that_of_two_tables(made):
    effects = {"tooth_coupling": "off"}
    whole, without = (analyze(PAIR, **ASKED, effects=e) for e in ({}, effects))
    entry = next(one for one in made.effects if one.name == "tooth_coupling")
    assert entry.on
    for k, force in enumerate(whole.force):
        curves = [table.curve(force=float(force)) for table in (whole, without)]
        assert made.nominal.mean[k] == curves[0].mean.value
        assert entry.mean_change[k] == curves[1].mean.value - curves[0].mean.value
        assert entry.peak_to_peak_change[k] == curves[1].peak_to_peak.value - curves[0].peak_to_peak.value
        first = curves[1].harmonics[0].value - curves[0].harmonics[0].value
        assert entry.harmonic_change[k, 0] == pytest.approx(first, rel=1e-12, abs=0.0)


def test_estimates_are_within_a_factor_of_two(made):
    for entry in made.effects:
        estimate, measured = entry.estimate, made.measured(entry)
        assert (estimate.torque, estimate.misalignment) == (measured.torque, measured.misalignment)
        for name in ("mean", "peak_to_peak"):
            if abs(getattr(measured, f"relative_{name}")) > 0.01:
                ratio = getattr(estimate, name) / getattr(measured, name)
                assert 0.5 < ratio < 2.0, (entry.name, ratio)


@pytest.mark.law
@pytest.mark.parametrize(("start", "tasks"), [(0.0, "solve_block"), (2.0, "_attempted"), (9.0, None)])
def test_large_tables_are_shared_by_their_blocks_and_small_ones_whole(made, start, tasks, monkeypatch):
    """`start`: seconds that pay for workers, in those that one of the tables takes."""
    request = Ablation.request(PAIR, *table_request(**ASKED))
    seconds = request.predicted(request.planned(None), None, with_errors=False).cpu_seconds
    monkeypatch.setattr(dispatch, "START_SECONDS", start * seconds)
    monkeypatch.setattr(contact_lines, "TASK_SECONDS", 1e-3)
    only, names = ["tooth_coupling", "corner_contact", "profile_modification"], set()

    class Noting:
        cost = RunCost()

        def run(self, function, shared, items):
            names.add(function.__name__)
            return (function(shared, item) for item in items)

    shared = ablate(PAIR, *table_request(**ASKED), Run(workers=Noting()), only=only)
    assert names == ({tasks} if tasks else set())
    for effect, alone in zip(shared.effects, made.effects, strict=False):
        assert effect.mean_change.tolist() == alone.mean_change.tolist()


def test_what_is_left_out_is_named_and_an_unknown_effect_refused(made):
    assert made.omitted == {"misalignment": "the gears are aligned"}
    assert [entry.name for entry in made.effects] == [
        "tooth_coupling", "corner_contact", "profile_modification", "finite_width",
    ]  # fmt: skip
    written = json.loads(json.dumps(RUN.figures(made), allow_nan=False))
    assert written["effects"][0]["estimate"]["mean_um"] == made.effects[0].estimate.mean / 1e-6
    with pytest.raises(InputError, match="only"):
        ablate(PAIR, TableAxes(normal_forces=[1000.0]), only=["windage"])


def test_an_effect_that_is_off_is_switched_on(made):
    off = ablate(
        PAIR,
        *table_request(effects={"tooth_coupling": "off"}, **ASKED),
        only=["tooth_coupling"],
    )
    (entry,) = off.effects
    (usual,) = [one for one in made.effects if one.name == "tooth_coupling"]
    assert not entry.on
    np.testing.assert_array_equal(entry.mean_change, usual.mean_change)
    np.testing.assert_array_equal(off.nominal.mean, usual.without_effect.mean)


def test_longer_periods_cost_more():
    early = PitchDeviation((3e-6, *([0.0] * 19)))
    pair = GearPair(replace(GEAR, pitch_deviation=early), GEAR)
    (entry,) = ablate(pair, *table_request(**ASKED), only=["pitch_error"]).effects
    # twenty base pitches to solve instead of one, over the same finite elements
    assert entry.with_effect.predicted_cpu_seconds > entry.without_effect.predicted_cpu_seconds + 0.01
    assert entry.cost_ratio > 1.0


def test_what_no_plane_holds_stays_in():
    asked = ASKED | {"misalignments": [10e-6], "positions": 16}
    made = ablate(GearPair(GEAR, GEAR), *table_request(**asked), only=["face_load_distribution"])
    assert made.effects == ()
    assert "misalignments" in made.omitted["face_load_distribution"]


def test_a_tolerance_chooses_one_mesh_for_all_tables(monkeypatch):
    made = []

    def noted(checked, *further):
        made.append((checked.request.options.level, checked.request.options.tolerance))
        return compute_database(checked, *further)

    monkeypatch.setattr(ablation, "compute_database", noted)
    asked = {"normal_forces": [2500.0], "tolerance": 0.05, "positions": 16}
    found = ablate(PAIR, *table_request(**asked), only=["tooth_coupling"])
    assert len(found.effects) == 1
    assert made == [("draft", None)] * 2


FORCE = 2000.0


@pytest.fixture(scope="module")
def pair():
    gear = Gear(20, 4e-3, 25e-3, 40e-3, thickness_allowance=60e-6)
    return GearPair(gear, gear, 80e-3)


def sensitivity(pair, **options):
    options = {"misalignments": [30e-6], "center_distance_changes": [-50e-6, 80e-6]} | options
    return study_sensitivity(
        pair,
        *table_request(normal_forces=[FORCE], level="draft", positions=16, **options),
    )


@pytest.fixture(scope="module")
def plain(pair):
    return sensitivity(pair)


@pytest.mark.parametrize("corners", [False, True])
def test_the_curves_are_those_of_tables(pair, plain, corners):
    found = plain[corners]
    assert found.corner_contact is corners
    effects = {"corner_contact": "on" if corners else "off"}
    options = {
        "level": "draft",
        "positions": 16,
        "model": "3d",
        "effects": effects,
    }
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
    curve = RippleCurve(np.array([-1e-5, 0.0, 2e-5]), np.array([3e-6, 2e-6, 8e-6]), np.zeros(3), np.ones(3))
    assert curve.relative_change == pytest.approx([0.5, 0.0, 3.0])


def test_a_case_may_choose_other_effects(pair, plain):
    loose, _ = sensitivity(pair, effects={"tooth_coupling": "off", "corner_contact": "on"})
    assert loose.corner_contact is False
    assert loose.misalignment.peak_to_peak[0] > 1.05 * plain[0].misalignment.peak_to_peak[0]


def test_what_a_study_cannot_vary_is_named(pair):
    with pytest.raises(InputError) as caught:
        sensitivity(pair, model="plane_strain")
    assert caught.value.field == "misalignments"
    with pytest.raises(InputError, match="teeth jam") as caught:
        sensitivity(pair, center_distance_changes=[-2e-3])
    assert caught.value.field == "center_distance_changes[0]"
