"""Predicting a run, choice of a mesh; nothing is computed."""

import json
import math
import re
from dataclasses import replace

import pytest
from analysis_requests import table_request

from bounds import engineering
from fe_contact import (
    AllowedError,
    AnalysisOptions,
    FlankModification,
    Gear,
    GearPair,
    RunOut,
    TableAxes,
    ToothFlank,
    analyze,
)
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.run_plan import plan_run
from fe_contact.compliance.cache import cached_size
from fe_contact.errors import InputError
from fe_contact.planning import cost_model
from fe_contact.planning.cost_model import contact_seconds, expected_positions, memory_of_contact, predict_run
from fe_contact.planning.cost_of_derivatives import solved_pitches
from fe_contact.planning.expected_error import ExpectedError
from fe_contact.planning.planned import MeshOption, mesh_for_time, mesh_for_tolerance
from model_studies.run_log import FILE as LOG

LEVELS = ("draft", "standard", "fine")


@pytest.fixture(scope="module", autouse=True)
def condensed_once():
    """Condense each time: what that costs is what is predicted and logged."""


def pair(helix: float = 0.0, width: float = 8e-3, teeth: int = 20) -> GearPair:
    gear = Gear(teeth, 2e-3, width, teeth * 1e-3, helix_angle=helix)
    mate = Gear(teeth, 2e-3, width, teeth * 1e-3, helix_angle=-helix)
    return GearPair(gear, mate, teeth * 2e-3 / math.cos(helix))


def options(plane: float = 0.0, lasting: float = 0.0, **meshes: float) -> list[MeshOption]:
    """Meshes by their error, each five times as dear as the one before."""
    return [
        MeshOption(name, 1, ExpectedError(error, 0.0, 0.0, plane, lasting), 5.0**k)
        for k, (name, error) in enumerate(meshes.items())
    ]


def test_a_tolerance_takes_the_cheapest_mesh_or_slices_that_meet_it():
    known = options(draft=0.02, standard=0.005, fine=0.001)
    for turned in (known, known[::-1]):
        chosen = [mesh_for_tolerance(AllowedError(t), turned) for t in (0.1, 0.01, 0.002)]
        assert [choice.level for choice in chosen] == list(LEVELS)
        assert all(choice.met for choice in chosen)
    few = MeshOption("draft", 15, ExpectedError(2e-3, 0.05, 0.0, 0.0, 0.5), 1.0)
    many = MeshOption("draft", 61, ExpectedError(2e-3, 0.005, 0.0, 0.0, 0.5), 2.0)
    fine = MeshOption("fine", 31, ExpectedError(1e-3, 0.007, 0.0, 0.0, 0.5), 20.0)
    assert mesh_for_tolerance(AllowedError(0.01), [few, many, fine]).option is many
    assert mesh_for_tolerance(AllowedError(0.1), [few, many, fine]).option is few
    beyond = mesh_for_tolerance(AllowedError(1e-4), options(draft=3e-3, standard=2e-3, fine=1e-3))
    assert (beyond.level, beyond.met) == ("fine", False)
    flat = mesh_for_tolerance(AllowedError(1e-2), options(3e-2, draft=2e-2, standard=5e-3, fine=1e-3))
    assert (flat.level, flat.met) == ("standard", False)
    lasts = options(lasting=3e-2, draft=2e-2, standard=5e-3, fine=1e-3)
    kept = mesh_for_tolerance(AllowedError(1e-2), lasts)
    assert (kept.level, kept.met, kept.reason) == ("standard", True, "expected error 0.5 %")
    assert "plane 3 %" in flat.reason
    seconds = {"draft": 1.0, "standard": 3.0, "fine": 10.0}
    found = [mesh_for_time(t, known, lambda o: seconds[o.level]).level for t in (1.5, 5.0, 50.0)]
    assert found == list(LEVELS)
    late = mesh_for_time(0.1, known, lambda o: seconds[o.level])
    assert (late.level, late.met) == ("draft", False)


def test_a_plan_computes_nothing(monkeypatch):
    """Neither a mesh nor a compliance nor a contact is requested."""
    for place in (
        "host.children.json_child.subprocess.Popen",
        "fe_contact.analysis.pairs.pair_contact.solve_contact",
        "fe_contact.compliance.flank_compliance_2d.compute_flank_compliance",
        "fe_contact.compliance.cyclic_compliance.compute_flank_compliance_3d",
    ):
        monkeypatch.setattr(place, lambda *_, **__: pytest.fail("computed"))
    for made in (
        plan_run(pair(), TableAxes(normal_forces=[500.0])),
        plan_run(pair(0.3), TableAxes(normal_forces=[500.0])),
    ):
        assert made.chosen.cost.cpu_seconds > 0.0
        assert made.plan.level == made.choice.level == "standard"


def test_finer_meshes_cost_more_and_err_less():
    for levels in (
        plan_run(p, TableAxes(normal_forces=[500.0])).levels for p in (pair(), pair(0.3), pair(teeth=60))
    ):
        seconds = [entry.cost.cpu_seconds for entry in levels]
        errors = [entry.error.total for entry in levels]
        assert seconds == sorted(seconds)
        assert errors == sorted(errors, reverse=True)


def test_more_loads_positions_and_alignments_cost_more():
    def contact(**more):
        made = plan_run(
            pair(), *table_request(**{"normal_forces": [500.0], "positions": 64, "model": "3d"} | more)
        )
        return made.chosen.cost.stages["contact"]

    plain, twice = contact(), contact(positions=128)
    assert contact(positions=192) - twice == pytest.approx(twice - plain)
    assert 1.5 * plain < twice < 2.0 * plain  # a table takes some time whatever its positions
    assert contact(normal_forces=[100.0, 200.0, 500.0]) > plain
    assert contact(misalignments=[0.0, 1e-5]) > plain
    assert contact(center_distance_changes=[0.0, 1e-5]) > 1.5 * plain


def test_slices_change_no_positions_but_their_cost():
    """Contact is at points of the lines, and steps where slices come into contact are gone."""
    wide = pair(helix=0.4, width=40e-3)
    asked = check_request(wide, TableAxes(normal_forces=[500.0]), AnalysisOptions(level="fine"))
    few, many = (decide(asked).in_slices(count).plan for count in (15, 31))
    assert expected_positions(wide, few) == expected_positions(wide, many)
    costs = [sum(contact_seconds(wide, plan, asked.model, (1, 1), with_errors=False)) for plan in (few, many)]
    assert 2.0 < costs[1] / costs[0] < 4.0


def test_tolerance_and_time_that_cannot_both_be_had_are_said():
    wish = {"normal_forces": [500.0], "tolerance": AllowedError(0.002, 0.0), "model": "3d"}
    level = {"normal_forces": [500.0], "level": "fine", "model": "3d"}
    assert plan_run(pair(), *table_request(**wish), time_budget=1e4).conflict == ""
    tight = plan_run(pair(), *table_request(**wish), time_budget=1e-3)
    assert "cannot be had" in tight.conflict
    assert "even the fastest mesh" in tight.conflict
    needed = [entry.cost.cpu_seconds for entry in tight.levels]
    between = plan_run(pair(), *table_request(**wish), time_budget=0.5 * (needed[0] + needed[1]))
    assert (between.choice.level, between.choice.met) == ("draft", False)
    assert f"predicted {needed[0]:.2g} CPU s" in between.conflict
    assert "cannot be had: it needs" in plan_run(pair(), *table_request(**level), time_budget=1e-3).conflict
    assert plan_run(pair(), *table_request(**level), time_budget=1e4).conflict == ""
    with pytest.raises(InputError, match="time_budget"):
        plan_run(pair(), *table_request(**wish), time_budget=-1.0)


@pytest.mark.parametrize("budget", [1.0, 6.0, 14.0])
@pytest.mark.parametrize("tolerance", [AllowedError(0.002), AllowedError(0.05, 1e-7)])
def test_time_and_error_are_the_same_in_the_reason_and_in_the_levels(tolerance, budget):
    """Of the mesh that is taken and of the one that the tolerance needs, in whatever slices."""
    options = AnalysisOptions(tolerance=tolerance, time_budget=budget)
    plan = plan_run(pair(0.3), TableAxes(torques=[40.0]), options)
    seconds = {engineering(row.cost.cpu_seconds, 2) for row in plan.levels}
    errors = {engineering(100.0 * row.error.numerical, 2) for row in plan.levels}
    reason = plan.choice.reason
    assert set(re.findall(r"(?:take|predicted) ([0-9.]+) CPU s", reason)) <= seconds, (reason, seconds)
    assert set(re.findall(r"expected error ([0-9.]+) %", reason)) <= errors, (reason, errors)
    assert plan.chosen in plan.levels


def test_a_mesh_that_is_tried_first_is_planned_with_the_one_that_is_expected_to_follow():
    options = AnalysisOptions(tolerance=AllowedError(2e-3, 1e-9))
    plan = plan_run(pair(0.15, width=40e-3), TableAxes(torques=[200.0]), options)
    assert "tried first" in plan.choice.reason and plan.passes[0] == plan.chosen
    assert [entry.level for entry in plan.passes] == ["draft", "fine"]
    assert all(entry in plan.levels for entry in plan.passes)
    expected = decide(plan.checked, None).predicted(None)
    assert plan.to_json()["passes"][1]["cost"]["cpu_seconds"] == pytest.approx(expected.cpu_seconds)
    alone = plan_run(pair(0.15), TableAxes(torques=[40.0]), AnalysisOptions(level="standard"))
    assert alone.passes == (alone.chosen,)


def test_a_run_keeps_what_was_predicted_beside_what_happened(tmp_path):
    """Also in the log; compliances that are in the cache are predicted to cost nothing."""
    asked = {"normal_forces": [500.0], "model": "plane_strain", "level": "draft", "positions": 8}
    planned = plan_run(pair(), *table_request(**asked), cache=tmp_path)
    first = analyze(pair(), **asked, cache=tmp_path).metadata.receipt
    assert first["prediction"]["stages"] == pytest.approx(planned.chosen.cost.stages)
    assert first["prediction"]["error"]["total"] > 0.0
    logged = [json.loads(line) for line in (tmp_path / LOG).read_text(encoding="utf-8").splitlines()]
    assert {"plane compliance", "plane error estimate"} <= {entry["stage"] for entry in logged}
    second = analyze(pair(), **asked, cache=tmp_path).metadata.receipt
    assert second["prediction"]["stages"]["compliance"] < 0.1 * first["prediction"]["stages"]["compliance"]
    assert second["stages"]["compliance"]["cpu_seconds"] < first["stages"]["compliance"]["cpu_seconds"]


@pytest.mark.parametrize("relief", [0.0, 10e-6])
def test_a_plan_tells_the_error_that_its_mesh_is_chosen_by(relief):
    """Modified helical pairs have a ripple of their own; the list of meshes knows it as the choice does."""
    helical = pair(helix=0.3)
    relieved = FlankModification(tip_relief=relief, tip_relief_length=1e-3 if relief else 0.0)
    gear = replace(helical.pinion, modification=relieved)
    found = plan_run(
        replace(helical, pinion=gear), *table_request(torques=[20.0, 60.0], tolerance=AllowedError(0.05))
    )
    assert found.chosen.error == found.choice.option.error


def predicted_memory(gears, cache=None, **options):
    checked = check_request(gears, *table_request(normal_forces=[1000.0], **{"level": "draft"} | options))
    plan = decide(checked, cache).plan
    return predict_run(gears, plan, checked.model, checked.request.alignments, cache).memory_bytes


def test_memory_grows_with_meshes_positions_and_slices():
    plane, face = pair(), pair(helix=0.3)
    for gears in (plane, face):
        sizes = [predicted_memory(gears, level=level) for level in LEVELS]
        assert cost_model.PROCESS_BYTES < sizes[0] < sizes[1] < sizes[2]
    assert predicted_memory(face, positions=4096) > 1.3 * predicted_memory(face, positions=64)
    plan = decide(check_request(face, TableAxes(normal_forces=[1000.0]), AnalysisOptions(level="draft"))).plan
    finer = replace(plan, discretization=replace(plan.discretization, slices=61))
    ratio = 61 / plan.discretization.slices

    def bytes_of(made):
        return memory_of_contact(face, made, 1, (1, 1))

    assert ratio < bytes_of(finer) / bytes_of(plan) < ratio**2


def test_kept_compliances_take_the_memory_of_their_files(tmp_path, monkeypatch):
    assert cached_size(None, "key") == cached_size(tmp_path, "key") == 0
    (tmp_path / "compliance-key.npz").write_bytes(bytes(17))
    assert cached_size(tmp_path, "key") == 17
    # Nothing is factorised then: every gear and mesh counts with the bytes that are read.
    gears = pair(helix=0.3)
    fresh = predicted_memory(gears, tmp_path)
    monkeypatch.setattr(cost_model, "solid_cached", lambda *_: 3_000_000)
    kept = predicted_memory(gears, tmp_path)
    plan = decide(
        check_request(gears, TableAxes(normal_forces=[1000.0]), AnalysisOptions(level="draft"))
    ).plan
    alike = 2 * 3_000_000  # gears alike but for the hand are read once, the mesh and the coarse one
    beside = 1.25 * 3_000_000  # the mirror image of one, and a gathered block
    assert kept == int(cost_model.PROCESS_BYTES + memory_of_contact(gears, plan, 1, (1, 1)) + alike + beside)
    assert kept < fresh


def test_pitches_solved_by_derivatives_do_not_grow_with_the_period():
    """They are drawn and further ones until the errors are small enough; counted where they are solved."""
    for in_table in (False, True):
        counts = [solved_pitches(period, in_table=in_table) for period in (200, 391, 1541)]
        assert len(set(counts)) == 1
        assert counts[0] == tuple(sorted(counts[0]))
    assert solved_pitches(391, in_table=True) > solved_pitches(391, in_table=False)


def test_no_more_pitches_are_expected_than_there_are():
    for period in (1, 10, 24, 40):
        assert max(solved_pitches(period, in_table=True)) <= period


def test_more_positions_are_expected_where_teeth_differ():
    """As many as rows allow: their handovers are apart. None where they are requested, nor for run-out."""
    gears = pair()
    few, requested = (
        check_request(gears, *table_request(torques=[40.0], level="draft", positions=count)).plan("draft")
        for count in (None, 20)
    )
    unlike, turning = (
        replace(gears, pinion=replace(gears.pinion, **own))
        for own in ({"tooth_flanks": (ToothFlank(1, 3e-6),)}, {"run_out": RunOut(5e-6)})
    )
    alike, differing, longest = (expected_positions(unlike, few, period) for period in (1, 391, 2300))
    assert differing > alike > longest == few.nodes.start + 1
    assert expected_positions(turning, few, 391) == alike
    assert {expected_positions(unlike, requested, period) for period in (1, 391)} == {20}


@pytest.mark.parametrize("model", ["3d", "plane_strain"])
def test_positions_of_spur_pairs_are_those_expected_at_one_load_and_at_several(model):
    """Handovers move with the load: each has positions of its own."""
    wide = GearPair(*[Gear(20, 4e-3, 8e-3, 40e-3)] * 2, 80e-3)
    for loads in ([5e2], [1e2, 4e2, 1e3, 2e3]):
        asked = check_request(wide, *table_request(normal_forces=loads, level="draft", model=model))
        solved = analyze(asked).position.size
        assert 0.8 < expected_positions(wide, decide(asked).plan) / solved < 1.25


@pytest.mark.parametrize(
    ("tolerance", "minimum", "maximum"), [(None, 0.6, 1.6), (AllowedError(0.05, 1e-7), 0.65, 1.4)]
)
def test_positions_of_helical_pairs_do_not_grow_with_the_loads(tolerance, minimum, maximum):
    """Their handovers are gentle; without a floor their small ripple asks for more."""
    gears = pair(helix=0.35, width=20e-3)
    level = {"level": "draft"} if tolerance is None else {"tolerance": tolerance}
    for loads in ([2e3], [2e2 * 1.3**k for k in range(12)]):
        asked = check_request(gears, *table_request(normal_forces=loads, model="3d", **level))
        solved = analyze(asked).position.size
        assert minimum < expected_positions(gears, decide(asked).plan) / solved < maximum
