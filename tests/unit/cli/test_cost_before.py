"""What a study costs is said before it begins, and by the status of a folder; it grows with the work."""

import json
import re
import tomllib
from collections import Counter, OrderedDict
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from command_line import loa
from housing_solid import write_housed_scene
from repository import EXAMPLES
from spur_case import spur_case

from bounds import engineering
from dynamics.acoustics import BoundaryElements, ElementalRadiators
from dynamics.assembly.assemble import assemble
from dynamics.influence import neglected_check
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.microgeometry import evaluator
from fe_contact.microgeometry.design_study import design_study
from fe_contact.microgeometry.tolerance_study import curves_of_samples
from fe_contact.options import Run
from fe_contact.planning.cost_of_derivatives import ContactWork
from host.directories import cache_home
from lineofaction.cli import run_study, simulate
from lineofaction.cli.costs import simulation_cost, study_cost, table_cost
from lineofaction.cli.scene_tables import tabled_scene
from lineofaction.cli.status import run_status
from lineofaction.gearbox.convert import plan
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.plan import plan_of
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.cost import LONG, StudyCost, Work
from lineofaction.gearbox.studies.deflect import run as deflect
from lineofaction.gearbox.studies.noise.run import USUAL_LINE
from lineofaction.gearbox.studies.scatter import run as scatter
from lineofaction.gearbox.studies.scene_before_tables import CASES
from lineofaction.gearbox.studies.study import run
from lineofaction.gearbox.subjects import scene_of
from model_studies.stage_clock import StageClock

sound_band_module = import_module("dynamics.noise.sound_band")
steady_cost_module = import_module("dynamics.periodic.steady_cost")
SPEEDS = [100.0 * k for k in range(1, 61)]
CHANGE: dict[str, Any] = {
    "after": tomllib.loads((EXAMPLES / "palermo_spur_20_20.toml").read_text()),
    "speed_rpm": SPEEDS[:6],
    "orders": 4,
    "load_cases": [{"name": "whole"}],
}
GROWING: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "sensitivity": (
        {"misalignment_um": [0.0], "center_distance_change_percent": [0.0, 0.1]},
        {"misalignment_um": [0.0, 5.0, 10.0], "center_distance_change_percent": [0.0, 0.1, 0.2]},
    ),
    "optimize": ({"search": {"trials": 0}}, {"search": {"trials": 6}}),
    "sweep": ({"over": ["torque=50:100:50"]}, {"over": ["pinion.profile_crowning=0:16:2"]}),
    "scatter": ({"samples": 64}, {"samples": 4096}),
    "ablate": ({"only": ["tooth_coupling"]}, {}),
    "frontier": ({"up_to": "corrected_fine"}, {}),
    "modes": ({"speed_rpm": SPEEDS[:6]}, {"speed_rpm": SPEEDS}),
    "steady": ({"speed_rpm": SPEEDS[:6]}, {"speed_rpm": SPEEDS}),
    "response": ({"speed_rpm": SPEEDS[:6]}, {"speed_rpm": SPEEDS}),
}
OF_SCENES = ("modes", "steady", "response")


@pytest.fixture
def case(tmp_path):
    file = tmp_path / "case.toml"
    file.write_text(spur_case(torques=[100.0]))
    return CheckedCase(read_model(Case, file))


def predicted(verb: str, inputs: dict[str, Any], case: CheckedCase) -> StudyCost:
    study = STUDIES[verb]
    subject, folder = scene_of(EXAMPLES / "jeffcott_scene.toml") if verb in OF_SCENES else (case, Path())
    checked = validated(study.inputs, inputs)
    cost = study_cost(study, study.run.narrowed(subject, checked), folder, checked)
    assert cost is not None
    return cost


@pytest.mark.parametrize("verb", GROWING)
def test_a_prediction_is_made_and_grows_with_the_work(verb, case):
    less, more = (predicted(verb, inputs, case) for inputs in GROWING[verb])
    assert 0.0 < less.seconds < more.seconds
    assert less.seconds == pytest.approx(sum(part.seconds for part in less.parts))


def test_what_is_not_afforded_says_why_and_what_one_motion_takes(case, monkeypatch):
    """By the same count: as long a period and as many states, of the highest speed alone."""
    study, (scene, folder) = STUDIES["steady"], scene_of(EXAMPLES / "palermo_scene.toml")
    monkeypatch.setattr(steady_cost_module, "period_seconds", lambda *_: 1.0)
    monkeypatch.setattr(steady_cost_module, "AFFORDED", 0.0)
    costs = {}
    for count in (1, 30):
        speeds = [100.0 * (30 - count + k) for k in range(1, count + 1)]
        cost = study_cost(study, scene, folder, validated(study.inputs, {"speed_rpm": speeds}))
        assert cost is not None
        costs[count] = cost
    one, many = costs[1], costs[30]
    assert one.seconds < LONG < many.seconds and one.remedy == ""
    assert f"at 3000 rpm takes {engineering(one.seconds, 2)} CPU s" in many.remedy
    assert f"({engineering(many.seconds / 3600.0, 2)} h)" in many.text and many.text.endswith(many.remedy)
    assert (StudyCost(()) + many).text == many.text


def test_of_a_usual_search_a_scatter_costs_by_its_nodes(case):
    alone = predicted("optimize", {"torque_n_m": [100.0]}, case)
    scatter = {"pinion": {"profile_slope_um": 2.0}, "points": 5}
    spread = predicted("optimize", {"torque_n_m": [100.0], "scatter": scatter}, case)
    designs = [next(part for part in cost.parts if part.name == "designs") for cost in (alone, spread)]
    assert designs[1].seconds == pytest.approx(5.0 * designs[0].seconds, rel=0.3)


def test_drawn_teeth_cost_each_solved_pair_a_revolution_of_their_gear():
    """As many base pitches as it has teeth, whatever the sample; none where no order is beside the mesh."""
    case = CheckedCase(read_model(Case, EXAMPLES / "industrial_spur_21_59.toml"))

    def revolutions(limit, samples=64):
        inputs = {"samples": samples, "exact": 12, "finishing": "hobbing", "limit": limit}
        return [part for part in predicted("scatter", inputs, case).parts if part.name == "revolutions"]

    assert revolutions("1=1um") == []
    by_gear = {gear: revolutions(f"1-{gear}=60nm")[0] for gear in ("pinion", "wheel")}
    assert {work.pieces for work in by_gear.values()} == {12}
    assert by_gear["wheel"].piece_seconds / by_gear["pinion"].piece_seconds == pytest.approx(59 / 21)
    assert revolutions("1-pinion=60nm", 4096) == [by_gear["pinion"]]


def test_pairs_of_scatter_are_solved_on_one_compliance(case, monkeypatch):
    """Told are the positions that are assembled once, and the points of every pair, as they are counted."""
    inputs = validated(STUDIES["scatter"].inputs, {"samples": 5, "exact": 5})
    request, counts = case.request(scatter.scatter_request, inputs), Counter[str]()
    study = design_study(request.space, request.torques, [], StageClock(), Run(), request.checked)
    assembled, solved = PairContact._assembled, evaluator.solve_contact

    def counted_positions(own, candidates, couple):
        counts["compliance"] += candidates.position.size
        return assembled(own, candidates, couple)

    def counted_points(problem, load):
        counts["pairs"] += problem.candidates.position.size * load.size
        return solved(problem, load)

    monkeypatch.setattr(PairContact, "_assembled", counted_positions)
    monkeypatch.setattr(evaluator, "solve_contact", counted_points)
    names = tuple(request.tolerances.widths)
    curves_of_samples((study.evaluator, names), (False, request.tolerances.sample(5, 0)))
    monkeypatch.setattr(ContactWork, "of", lambda _, positions, __: positions)
    monkeypatch.setattr(ContactWork, "of_flanks", lambda _, positions, loads: positions * loads)
    monkeypatch.setattr(scatter, "_DRAWN_FLANKS", 1.0)  # points are counted, whatever one costs
    told = {part.name: part for part in predicted("scatter", {"samples": 5, "exact": 5}, case).parts}
    assert told["pairs"].pieces == 5 + scatter._TANGENT
    assert counts == {"pairs": 5 * told["pairs"].piece_seconds, "compliance": told["compliance"].seconds}


@pytest.mark.parametrize("misalignment", [0.0, 10.0])
def test_a_pair_of_scatter_is_solved_once_however_it_is_misaligned(misalignment):
    case = CheckedCase(read_model(Case, EXAMPLES / "helical_ev_23_67.toml"))
    inputs = {"samples": 40, "exact": 40, "misalignment_um": misalignment}
    (pairs,) = (part for part in predicted("scatter", inputs, case).parts if part.name == "pairs")
    assert pairs.pieces == pytest.approx(40 + 10 * scatter._TANGENT)


def test_contacts_of_a_deflection_come_with_their_errors(monkeypatch):
    own = deflect.predicted_designs

    def priced(checked, cache):
        return own(checked, cache)._replace(design=1.0, errors=2.0, across_face=True)

    monkeypatch.setattr(deflect, "predicted_designs", priced)
    scene, folder = scene_of(EXAMPLES / "flexible_shafts_scene.toml")
    cost = study_cost(STUDIES["deflect"], scene, folder, STUDIES["deflect"].inputs())
    parts = {part.name: part for part in cost.parts}
    assert parts["contacts"].piece_seconds == parts["tables by misalignment"].piece_seconds == 3.0
    deflections = {part.stage: part.pieces for part in cost.parts if part.name == "deflections"}
    assert deflections == {"deflection": 1, "flanks": 3}  # of one load case: before, and in three passes


def test_the_cost_is_said_as_parts_of_a_whole():
    gears, values = Work("gears", 1.6), Work("values", 1.6, 24)
    whole = StudyCost((gears,), 2.0**30) + StudyCost((values, Work("values", 0.8, 24), Work("beside", 0.01)))
    assert whole.text == "about 59 CPU s, 1 GiB: gears 1.6 s, 48 values at 1.2 s"


@pytest.mark.parametrize("seconds", [1.0, 40.0])
def test_the_verb_says_more_than_a_moment_on_standard_error(seconds, case, monkeypatch, capsys):
    monkeypatch.setattr(run_study, "study_cost", lambda *_: StudyCost((Work("values", seconds / 8.0, 8),)))
    monkeypatch.setattr("lineofaction.cli.costs.host_slowness", lambda _: 2.0)
    targets = Path("sensitivity.nc"), Path("sensitivity.html")  # one is drawn
    run_study._announced_cost(STUDIES["sensitivity"], [run_study._Subject(case, Path())], None, {}, targets)
    printed = capsys.readouterr()
    assert printed.out == ""
    said = "loa sensitivity: about 48 CPU s: 8 values at 5 s, program and files 8.4 s\n"
    assert printed.err == (said if seconds == 40.0 else "")


def test_a_run_says_its_cost_and_that_of_its_tables(monkeypatch, tmp_path):
    for name, work in (("simulation_cost", Work("run", 30.0)), ("tables_cost", Work("tables", 10.0))):
        monkeypatch.setattr(simulate, name, lambda *_, work=work: StudyCost((work,)))
    scene = tmp_path / "scene.toml"
    scene.write_text((EXAMPLES / "jeffcott_scene.toml").read_text())
    said = "loa simulate: about 40 CPU s: run 30 s, tables 10 s\n"
    assert loa("simulate", scene, "-o", tmp_path / "run.nc", "--set", "run.duration_s=0.01").stderr == said


def test_a_scene_that_a_study_refuses_is_left_out(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text((EXAMPLES / "lin_parker_planetary_scene.toml").read_text())
    for study in (STUDIES["steady"], STUDIES["response"]):
        inputs = validated(study.inputs, {"speed_rpm": [100.0, 200.0]})
        assert study_cost(study, *scene_of(scene), inputs) is None
    facts = json.loads(loa("status", tmp_path, "--json").stdout)
    seconds = {row["verb"]: row["cpu_seconds"] for row in facts["results"]}
    assert seconds["steady"] is seconds["response"] is None
    assert seconds["simulate"] > 0.0


@pytest.mark.parametrize("bearing", ["output left", "none"])
def test_a_search_by_sound_that_is_refused_leaves_the_status_whole(bearing, tmp_path):
    for name in ("palermo_scene.toml", "palermo_spur_20_20.toml"):
        (tmp_path / name).write_text((EXAMPLES / name).read_text())
    heard = f'[heard]\nspeed_rpm = [500, 900]\norders = 2\nbearing = "{bearing}"\n'
    (tmp_path / "search.toml").write_text(f"[variables.pinion]\nprofile_crowning_um = [0, 20]\n{heard}")
    facts = json.loads(loa("status", tmp_path, "--json").stdout)
    seconds = {row["verb"]: row["cpu_seconds"] for row in facts["results"]}
    assert (seconds["optimize"] is None) == (bearing == "none")
    assert seconds["modes"] > 0.0


def test_the_cost_of_a_run_grows_with_its_duration():
    scene, _ = scene_of(EXAMPLES / "lin_parker_planetary_scene.toml")
    longer = scene.model_copy(
        update={"run": scene.run.model_copy(update={"duration_s": 100.0 * scene.run.duration_s})}
    )
    costs = [simulation_cost(own, EXAMPLES) for own in (scene, longer)]
    less, more = (cost.seconds for cost in costs if cost is not None)
    assert more > 20.0 * less  # code of its own may be made for the longer


def study_inputs(levels: int, path: str, samples: int = 1) -> dict[str, Any]:
    factors: list[dict[str, Any]] = [{"path": path, "levels": [1.0 + k for k in range(levels)]}]
    if samples > 1:
        factors.append({"path": "meshes.mesh.damping_ratio", "uniform": {"low": 0.04, "high": 0.1}})
    return {"factors": factors, "responses": [{"quantity": "dte_rms"}], "samples": samples}


@pytest.mark.parametrize("samples", [1, 5])
def test_a_study_costs_its_runs_and_the_contact_of_other_flanks(samples, monkeypatch):
    """Every point is a run; samples of what is no flank need no other table."""
    study, (scene, folder) = STUDIES["study"], scene_of(EXAMPLES / "palermo_scene.toml")
    monkeypatch.setattr(run, "run_cost", lambda _, runs, __: StudyCost((Work("runs", 2.0, runs),)))
    for path, contacts in (("loads.brake.torque_n_m", 0), ("meshes.mesh.case.pair.pinion.tip_relief_um", 4)):
        inputs = validated(study.inputs, study_inputs(4, path, samples))
        cost = study_cost(study, scene, folder, inputs)
        pieces = {part.name: part.pieces for part in cost.parts}
        assert pieces["runs"] == 4 * samples
        assert pieces.get("contacts", 0) == contacts


def test_a_complaint_costs_its_lines_at_one_speed_and_of_a_case_next_to_nothing(case):
    study, (scene, folder) = STUDIES["complaint"], scene_of(EXAMPLES / "palermo_scene.toml")
    costs = {}
    for hertz in (150.0, 1500.0):
        inputs = validated(study.inputs, {"frequency_hz": hertz, "speed_rpm": 450.0})
        costs[hertz] = study_cost(study, study.run.narrowed(scene, inputs), folder, inputs)
    lines = [
        part.piece_seconds for cost in costs.values() if cost for part in cost.parts if part.name == "lines"
    ]
    one, ten = (each - neglected_check._VARYING for each in lines)
    assert ten == pytest.approx(10.0 * one)
    inputs = validated(study.inputs, {"frequency_hz": 150.0, "speed_rpm": 450.0})
    alone = study_cost(study, study.run.narrowed(case, inputs), folder, inputs)
    assert alone is not None and 0.0 < alone.seconds < 0.1


@pytest.fixture
def housed(tmp_path):
    """A folder with a scene in a housing with a surface, and its case."""
    scene = write_housed_scene(tmp_path) / "scene.json"
    table = json.loads(scene.read_text())
    del table["meshes"][0]["database_file"]
    table["meshes"][0]["case_file"], table["run"]["duration_s"] = "palermo_spur_20_20.toml", 5.0
    scene.write_text(json.dumps(table))
    (tmp_path / "palermo_spur_20_20.toml").write_text((EXAMPLES / "palermo_spur_20_20.toml").read_text())
    return scene


def test_a_vibration_costs_the_response_where_something_vibrates_and_no_run_is_named(housed):
    study, inputs = STUDIES["vibration"], {"speed_rpm": SPEEDS}
    costs = [
        study_cost(study, *scene_of(scene), validated(study.inputs, fields))
        for scene, fields in (
            (housed, inputs),
            (housed, {"run": "0" * 64}),
            (EXAMPLES / "palermo_scene.toml", inputs),
        )
    ]
    response = STUDIES["response"]
    alike = study_cost(response, *scene_of(housed), validated(response.inputs, inputs))
    assert costs == [alike, None, None] and alike is not None


def test_nodes_and_limits_of_a_search_are_in_its_cost():
    """Every node is a contact, also in the analyses; a limit may need a search on between the positions."""
    case = CheckedCase(read_model(Case, EXAMPLES / "palermo_spur_20_20.toml"))
    whole = tomllib.loads((EXAMPLES / "optimize_tip_relief.toml").read_text(encoding="utf-8"))
    free = {name: value for name, value in whole.items() if name not in ("scatter", "limits")}
    study = STUDIES["optimize"]

    def parts(fields):  # of two parts with the name of analyses the later one: those of other than the start
        cost = study.run.predicted(case, validated(study.inputs, fields), None)
        return {part.name: part for part in cost.parts}

    alone, scattered, limited = map(parts, (free, free | {"scatter": whole["scatter"]}, whole))
    for name in ("designs", "steps from the optimum"):
        assert scattered[name].seconds == pytest.approx(9.0 * alone[name].seconds)
    assert alone["analyses"].seconds < scattered["analyses"].seconds < 18.0 * alone["analyses"].seconds
    assert "designs within limits" not in scattered and limited["designs within limits"].seconds > 0.0
    assert limited["analyses"].pieces == scattered["analyses"].pieces + 1.0


def test_the_band_of_a_sound_costs_as_many_responses_as_it_has(housed, monkeypatch):
    """And two more where it stands on mounts, whose stiffness is guessed too."""
    study, (scene, folder) = STUDIES["noise"], scene_of(housed)
    fields = {"speed_rpm": [300.0, 600.0], "orders": 2, "radiation": "equivalent_radiated_power"}
    inputs, alone = (validated(study.inputs, {**fields, "band": band}) for band in (True, False))
    responses: list[float] = []
    forced = sound_band_module.forced_power

    def counted(*values):
        responses.append(1.0)
        return forced(*values)

    monkeypatch.setattr(sound_band_module, "forced_power", counted)
    tabled = tabled_scene(scene, folder, None, lambda *_: None)
    study.run.compute(tabled, inputs, Means(cache_home(), lambda *_: None))
    foot = scene.housings[0].feet[0].model_copy(update={"mount_stiffness_n_per_m": (1e6, 1e6, 1e6)})
    part = scene.housings[0].model_copy(update={"feet": (foot,)})
    mounted = scene.model_copy(update={"housings": (part,)})
    stands, hangs = (study_cost(study, own, folder, inputs) for own in (scene, mounted))
    assert (stands.parts[-1].pieces, hangs.parts[-1].pieces) == (len(responses), len(responses) + 2)
    assert study_cost(study, scene, folder, alone) == StudyCost(stands.parts[:-1])


def test_the_lines_of_a_sound_are_within_twice_those_that_boundary_elements_correct(housed, monkeypatch):
    """At a microphone too; a line costs what its usual hull does."""
    study, (scene, folder) = STUDIES["noise"], scene_of(housed)
    fields = {"speed_rpm": [300.0, 600.0], "orders": 2, "band": False, "microphone_mm": [40.0, 60.0, 1000.0]}
    inputs = validated(study.inputs, fields)
    panels: list[int] = []

    def by_monopoles(_model, hull, *of):
        panels.append(len(hull.triangles))
        return ElementalRadiators().resistance(hull, *of)

    monkeypatch.setattr(BoundaryElements, "resistance", by_monopoles)
    cost = study_cost(study, scene, folder, inputs)
    assert cost is not None
    tabled = tabled_scene(scene, folder, None, lambda *_: None)
    study.run.compute(tabled, inputs, Means(folder, lambda *_: None))
    (lines,) = (part for part in cost.parts if part.name == "lines by boundary elements")
    assert 0.5 <= lines.pieces / len(panels) <= 2.0
    each = [BoundaryElements().cost(count, 0.0, 0).seconds / USUAL_LINE.seconds for count in panels]
    assert all(0.5 < share < 2.0 for share in each)


def test_more_points_have_more_lines_up_to_the_most(housed):
    study, (scene, folder) = STUDIES["noise"], scene_of(housed)

    def pieces(**fields):
        cost = study_cost(study, scene, folder, validated(study.inputs, {"speed_rpm": SPEEDS[:6], **fields}))
        return next((part.pieces for part in cost.parts if "boundary" in part.name), 0.0)

    assert [pieces(orders=6), pieces(speed_rpm=SPEEDS, orders=10)] == [3, 4]
    assert pieces(boundary_elements=False) == 0.0


def test_a_sound_of_a_run_and_its_contacts_are_not_predicted(housed):
    study, (scene, folder) = STUDIES["noise"], scene_of(housed)
    for fields in ({"sensitivities": True, "speed_rpm": SPEEDS[:6]}, {"run": "0" * 64}):
        assert study_cost(study, scene, folder, validated(study.inputs, fields)) is None


def test_a_change_costs_two_contacts_a_pair_and_two_of_the_designs():
    study, (scene, folder) = STUDIES["change"], scene_of(EXAMPLES / "palermo_scene.toml")
    for samples in (10, 40):
        inputs = validated(study.inputs, CHANGE | {"tolerances": {"samples": samples}})
        cost = study_cost(study, scene, folder, inputs)
        assert [part.pieces for part in cost.parts] == [1, 2 * samples + 2]


def test_a_scene_is_assembled_once_for_all_verbs_that_ask_of_it(monkeypatch):
    scene, folder = scene_of(EXAMPLES / "palermo_scene.toml")
    scene = scene.model_copy(update={"run": scene.run.model_copy(update={"duration_s": 0.0123})})
    resolved: list[tuple[float | None, int]] = []

    def counted(own):  # steps of steady states end at the positions of the planned table
        resolved.append((own.highest_frequency, own.meshes[0].table.position.size))
        return assemble(own)

    monkeypatch.setattr("lineofaction.gearbox.studies.scene_before_tables.assemble", counted)
    for verb in ("modes", "response", "steady", "response"):
        inputs = validated(STUDIES[verb].inputs, {"speed_rpm": SPEEDS[:2]})
        assert study_cost(STUDIES[verb], scene, folder, inputs) is not None
    assert len(resolved) == len(set(resolved))


def test_a_study_whose_runs_nobody_predicts_is_left_out(monkeypatch):
    study, (scene, folder) = STUDIES["study"], scene_of(EXAMPLES / "palermo_scene.toml")
    costs = iter((StudyCost((Work("runs", 2.0),)), None, None))  # of one point it is known
    monkeypatch.setattr(run, "run_cost", lambda *_: next(costs))
    inputs = validated(study.inputs, study_inputs(4, "loads.brake.torque_n_m"))
    assert study_cost(study, scene, folder, inputs) is None


def test_the_status_sums_what_is_due(case, tmp_path):
    facts = json.loads(loa("status", tmp_path, "--json").stdout)
    due = [row["cpu_seconds"] for row in facts["results"] if row["state"] != "fresh"]
    known = [seconds for seconds in due if seconds is not None]
    assert facts["due_cpu_seconds"] == pytest.approx(sum(known))
    assert facts["not_predicted"] == len(due) - len(known) > 0
    said = loa("status", tmp_path).stdout.splitlines()[1]
    assert re.match(r"stale or missing: about [\d.]+ CPU s, without \d+ refused$", said)
    (tmp_path / "case.nc").write_bytes(b"")  # newer than the case
    less = json.loads(loa("status", tmp_path, "--json").stdout)
    assert less["due_cpu_seconds"] < facts["due_cpu_seconds"]


@pytest.mark.parametrize("subject", ["case", "scene"])
def test_the_status_has_the_cost_of_each_of_these_verbs(subject, case, tmp_path, request):
    verbs = {"ablate", "frontier", "root-stress"}
    if subject == "scene":
        verbs |= {"listen", "vibration", "noise", "complaint", "change"}
        (tmp_path / "case.toml").unlink()
        scene = request.getfixturevalue("housed")
        heard = {"complaint": {"frequency_hz": 150.0, "speed_rpm": 450.0}}
        scene.write_text(json.dumps(json.loads(scene.read_text()) | heard))
        (tmp_path / "change.json").write_text(json.dumps(CHANGE))
    facts = json.loads(loa("status", tmp_path, "--json").stdout)
    assert verbs <= {row["verb"] for row in facts["results"] if (row["cpu_seconds"] or 0.0) > 0.0}


def test_a_table_costs_what_its_plan_says(case):
    cost = table_cost(case.case)
    planned = plan_of(case, None, cache_home() / "compliance").chosen.cost
    assert cost.seconds == pytest.approx(planned.cpu_seconds)
    assert cost.bytes == planned.memory_bytes


def test_a_table_costs_every_pass_that_is_expected(case, monkeypatch):
    """A mesh that is expected to miss the tolerance is tried first: another is expected to follow."""
    decision, alone = plan._decision(case, None), table_cost(case.case)
    behind = replace(decision, plan=decision.checked.plan("fine"))
    monkeypatch.setattr(plan, "_decision", lambda *_: replace(decision, behind=behind))
    finer = behind.predicted(cache_home() / "compliance")
    both = table_cost(case.case)
    assert both.seconds == pytest.approx(alone.seconds + finer.cpu_seconds)
    assert both.bytes == max(alone.bytes, finer.memory_bytes)


def test_a_plan_prints_what_its_table_costs_in_both_passes(tmp_path):
    (tmp_path / "case.toml").write_text(
        "[pair]\nnormal_module_mm = 2.0\nhelix_angle_deg = 9.0\ncenter_distance_mm = 40.4986\n"
        "[pair.pinion]\nteeth = 20\nface_width_mm = 40.0\nbore_diameter_mm = 20.0\n"
        "[pair.wheel]\nteeth = 20\nface_width_mm = 40.0\nbore_diameter_mm = 20.0\n"
        "[load]\ntorque_n_m = [200.0]\n[accuracy]\ntolerance = 0.002\ntolerance_floor_nm = 1.0\n"
    )
    done = loa("plan", tmp_path / "case.toml")
    said = re.match(r"draft, 21 slices, then fine, 31 slices: ([\d.]+) CPU s", done.stdout)
    assert said, done.output
    cost = table_cost(read_model(Case, tmp_path / "case.toml"))
    assert said[1] == engineering(cost.seconds, 2)
    assert [row.split()[0] for row in re.findall("> (.*)", done.stdout)] == ["draft,", "fine,"]


def test_the_status_checks_each_case_of_a_unit_once(tmp_path, monkeypatch):
    loa("open", EXAMPLES / "two_stage" / "two_stage.rexs", "-o", tmp_path / "unit")
    checks: Counter[tuple[str, str]] = Counter()
    decisions: list[str] = []
    checked, decision = CheckedCase._checked, plan._decision

    def checked_and_counted(own, **how):
        checks[own.case.model_dump_json(), str(how)] += 1
        return checked(own, **how)

    def decided_and_counted(own, cache):
        decisions.append(own.case.model_dump_json())
        return decision(own, cache)

    monkeypatch.setattr(CheckedCase, "_checked", checked_and_counted)
    monkeypatch.setattr(CASES, "_cases", OrderedDict())
    monkeypatch.setattr(plan, "_decision", decided_and_counted)
    run_status(tmp_path / "unit", as_json=True)
    assert set(checks.values()) == {1}
    assert len(decisions) == len(set(decisions)) == 2
