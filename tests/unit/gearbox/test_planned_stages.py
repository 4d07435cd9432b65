"""The plan of a study has its work in the stages in which it is done."""

import tomllib
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from repository import EXAMPLES
from spur_case import spur_case

from dynamics.assembly.assemble import System, assemble
from dynamics.periodic.period_map import periodic_problem
from dynamics.periodic.steady_cost import SteadyCost
from fe_contact.analysis.run_plan import table_seconds
from fe_contact.microgeometry import evaluator
from fe_contact.microgeometry.design_study import design_study
from fe_contact.options import Run
from fe_contact.planning.cost_of_derivatives import ContactWork
from host.directories import cache_home
from lineofaction.cli import scene_tables
from lineofaction.gearbox import workbench
from lineofaction.gearbox.convert import plan
from lineofaction.gearbox.convert.checked_case import CheckedCase, CheckedCases
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.deflect import Inputs as DeflectInputs
from lineofaction.gearbox.studies.deflect.mesh_contact import DividedTables
from lineofaction.gearbox.studies.optimize import run as optimize_run
from lineofaction.gearbox.studies.optimize import sound_search
from lineofaction.gearbox.studies.scatter import run as scatter_run
from lineofaction.gearbox.studies.scene_before_tables import sized
from lineofaction.gearbox.studies.steady import run as steady_run
from lineofaction.gearbox.subjects import scene_of, with_inline_cases
from lineofaction.gearbox.tabled_scene import SceneRuns
from lineofaction.gearbox.units import RPM
from model_studies.progress import Progress
from model_studies.stage_clock import StageClock
from model_studies.workers import InProcess

pair_contact = import_module("fe_contact.analysis.pairs.pair_contact")

PLANE = {"model": "plane_strain"}
SCATTER = {"pinion": {"profile_slope_um": 3.0}, "wheel": {"profile_slope_um": 3.0}, "points": 3}
STUDIED: dict[str, dict[str, Any]] = {
    "flank": {},
    "root-stress": {},
    "scatter": {"samples": 8, "exact": 8},
    "optimize": {"search": {"trials": 0, "evaluations": 2, "sample": 0}},
}
"""Inputs of the studies that condense gears, as small as they may be."""


def plane_case() -> CheckedCase:
    return CheckedCase(validated(Case, tomllib.loads(spur_case(torques=[100.0], **PLANE))))


@pytest.mark.parametrize("name", STUDIED)
def test_gears_are_planned_in_the_stage_in_which_they_are_condensed(name, tmp_path, monkeypatch):
    """Coarse gears too, which yield the error of the mesh: the stage that is reported next has done them."""
    study, case = STUDIES[name], plane_case()
    inputs = validated(study.inputs, STUDIED[name])
    events: list[str] = []
    condensed = pair_contact.flank_compliances

    def recorded(*arguments: Any, **options: Any) -> Any:
        events.append("condensed")
        return condensed(*arguments, **options)

    monkeypatch.setattr(pair_contact, "flank_compliances", recorded)
    subject = study.run.narrowed(case, inputs)
    parts = {part.name: part for part in study.run.predicted(subject, inputs, tmp_path).parts}
    study.run.compute(subject, inputs, Means(tmp_path, lambda stage, _: events.append(stage)))
    stages = [
        next(event for event in events[place:] if event != "condensed")
        for place, event in enumerate(events)
        if event == "condensed"
    ]
    assert stages[0] == parts["gears"].stage
    assert stages[1] == parts["coarse gears"].stage


CONFIRMED: dict[str, tuple[str, dict[str, Any]]] = {
    "search": ("optimize", STUDIED["optimize"]),
    "search with limits": ("optimize", STUDIED["optimize"] | {"limits": {"max_pressure_mpa": 1e4}}),
    "samples": ("scatter", STUDIED["scatter"]),
    "samples of teeth": ("scatter", {"samples": 8, "finishing": "hobbing", "limit": "1-pinion=60nm"}),
}
"""Studies that end with a table, and their inputs."""


@pytest.mark.parametrize("kind", CONFIRMED)
def test_a_table_at_the_end_is_reported_as_it_is_computed(kind, tmp_path):
    """By many fractions of its stage, which never fall and end at one; all stages are those of the study."""
    name, fields = CONFIRMED[kind]
    study, case = STUDIES[name], plane_case()
    reported: list[tuple[str, float]] = []
    means = Means(tmp_path, lambda *progress: reported.append(progress))
    study.run.compute(case, validated(study.inputs, fields), means)
    assert {stage for stage, _ in reported} <= {name for name, _ in study.stages}
    fractions = [fraction for stage, fraction in reported if stage == "confirmation"]
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    assert len(set(fractions)) > 5


def test_designs_of_a_search_are_priced_by_the_points_that_they_solve(monkeypatch):
    """At the few positions of the search, and at the loads that count: the table has more of both."""
    fields = {"torque_n_m": [50.0, 100.0], "search": {"positions": 16, "trials": 0}, "scatter": SCATTER}
    study, case = STUDIES["optimize"], plane_case()
    inputs = validated(study.inputs, fields)
    request, points = case.request(optimize_run._library_request, inputs), []
    solved = evaluator.solve_contact

    def counted(problem: Any, load: Any) -> Any:
        points.append(problem.candidates.position.size * load.size)
        return solved(problem, load)

    monkeypatch.setattr(evaluator, "solve_contact", counted)
    monkeypatch.setattr(ContactWork, "of_flanks", lambda _, positions, loads: positions * loads)
    torques = request.torques, request.further_torques
    designs = design_study(request.space, *torques, StageClock(), Run(), request.checked)
    names = (variable.name for variable in request.variables)
    designs.evaluator.evaluate(dict(zip(names, request.start_design, strict=True)))
    parts = {part.name: part for part in study.run.predicted(case, inputs, None).parts}
    assert parts["designs"].piece_seconds == sum(points) == 9 * 16 * 2


def test_a_table_at_the_end_is_priced_with_the_flanks_that_it_has():
    """Over the face a pair without deviations and the start of a search cost less than others."""
    case = CheckedCase(validated(Case, tomllib.loads(spur_case(torques=[100.0], model="3d"))))
    samples, search = (validated(STUDIES[name].inputs, STUDIED[name]) for name in ("scatter", "optimize"))
    request = case.request(scatter_run.scatter_request, samples)
    pairs = request.pair, request.checked.request.pair
    plain, deviating = (table_seconds(request.checked, pair, (1, 1), None) for pair in pairs)
    (table,) = (part for part in scatter_run.RUN.predicted(case, samples, None).parts if part.name == "table")
    assert table.seconds == plain < 0.8 * deviating
    parts = STUDIES["optimize"].run.predicted(case, search, None).parts
    start, optimum = (part.seconds for part in parts if part.name == "analyses")
    assert start < optimum


def two_cases() -> tuple[SceneInput, list[Case]]:
    """Return a scene of three meshes, of which the last has the case of the first, and both cases."""
    scene, _ = scene_of(EXAMPLES / "palermo_scene.toml")
    texts = [spur_case(torques=[torque], **PLANE) for torque in (100.0, 200.0)]
    cases = [validated(Case, tomllib.loads(text)) for text in texts]
    first, second = (scene.meshes[0].model_copy(update={"case": case, "case_file": None}) for case in cases)
    return scene.model_copy(update={"meshes": (first, second, first)}), cases


@pytest.mark.parametrize("first_is_cached", [False, True])
def test_tables_of_a_scene_are_one_stage_by_their_cost(first_is_cached, monkeypatch):
    """A table that is cached costs nothing; one of two meshes is computed once."""
    scene, cases = two_cases()
    seconds = {100.0: 1.0, 200.0: 3.0}
    monkeypatch.setattr(
        plan, "costs_of", lambda case, _: [SimpleNamespace(cpu_seconds=seconds[case.case.load.torque_n_m[0]])]
    )
    reported: list[tuple[str, float]] = []
    cached = cases[:1] if first_is_cached else []
    run = Run(progress=lambda *progress: reported.append(progress))
    runs = SceneRuns(scene, Path(), CheckedCases(), run, lambda case: case in cached)
    for case in cases[len(cached) :]:
        of_table = runs.of(case)
        of_table.on_plan({"compliance": 2.0, "contact": 2.0})
        of_table.progress("compliance", 1.0)
        of_table.progress("contact", 1.0)
    expected = [0.5, 1.0] if first_is_cached else [0.125, 0.25, 0.625, 1.0]
    assert [stage for stage, _ in reported] == ["analysis"] * len(expected)
    assert [fraction for _, fraction in reported] == pytest.approx(expected)


def scene_of_plane_case(folder: Path, positions: int) -> Path:
    scene = folder / "scene.toml"
    scene.write_text((EXAMPLES / "palermo_scene.toml").read_text())
    case = spur_case(torques=[100.0], positions=positions, **PLANE)
    (folder / "palermo_spur_20_20.toml").write_text(case)
    return scene


def by_the_verb(scene: Path, progress: Progress) -> None:
    scene_tables.tabled_scene(*scene_of(scene), None, progress)


@pytest.mark.parametrize("tabled", [workbench.tabled, by_the_verb])
def test_a_table_inside_a_study_is_part_of_its_stage(tabled, tmp_path):
    reported: list[tuple[str, float]] = []
    scene = scene_of_plane_case(tmp_path, positions=8)
    tabled(scene, lambda *progress: reported.append(progress))
    assert {stage for stage, _ in reported} == {"analysis"}
    fractions = [fraction for _, fraction in reported]
    assert fractions == sorted(fractions) and fractions[-1] == pytest.approx(1.0)


def test_tables_of_a_deflection_count_towards_those_of_usual_passes():
    """Of further passes the fraction stays: nothing follows that was planned."""
    bodies = SimpleNamespace(table=lambda _pair, _torques, misalignment: f"at {misalignment}")
    contact: Any = SimpleNamespace(bodies=bodies, pair=None, torques=None, tables={})
    fractions: list[float] = []
    tables = DividedTables({"first": contact, "second": contact}, InProcess(), 0.0, fractions.append, 4)
    tables.complete({"first": [0.0, 1.0], "second": [1.0]})
    tables.complete({"first": [0.0, 1.0, 2.0], "second": [3.0, 4.0]})
    assert fractions == [0.25, 0.5, 0.75, 1.0, 1.0]
    assert contact.tables == {float(k): f"at {float(k)}" for k in range(5)}


@pytest.mark.nightly
def test_a_deflection_is_reported_as_its_work_is_done(tmp_path):
    """Of a pair in three dimensions the tables at misalignments are most of the work on the flanks."""
    (tmp_path / "scene.toml").write_text((EXAMPLES / "flexible_shafts_scene.toml").read_text())
    case = spur_case(torques=[100.0], model="3d", positions=8)
    (tmp_path / "palermo_spur_20_20.toml").write_text(case)
    study, scene = STUDIES["deflect"], workbench.tabled(tmp_path / "scene.toml")
    reported: list[tuple[str, float]] = []
    means = Means(cache_home(), lambda *progress: reported.append(progress))
    study.run.compute(scene, validated(study.inputs, {}), means)
    assert {stage for stage, _ in reported} <= {name for name, _ in study.stages}
    flanks = [fraction for stage, fraction in reported if stage == "flanks"]
    assert flanks == sorted(flanks) and flanks[-1] == 1.0
    assert len(set(flanks)) >= 5  # the bodies, three tables at least, the contact


def test_steps_of_a_steady_state_are_planned_to_end_at_the_positions_of_its_table(tmp_path, monkeypatch):
    """At a high speed most steps of a period end there: those on a usual table are little more than half."""
    scene = scene_of_plane_case(tmp_path, positions=256)
    systems: list[System] = []

    def noted(system: System, *_: Any, **__: Any) -> SteadyCost:
        systems.append(system)
        return SteadyCost(1, 0.0, 0, 0.0, (), 1)

    monkeypatch.setattr(steady_run, "steady_cost", noted)
    study = STUDIES["steady"]
    inputs = validated(study.inputs, {"speed_rpm": [3000.0, 4000.0]})
    study.run.predicted(with_inline_cases(*scene_of(scene)), inputs, tmp_path)
    systems += [assemble(workbench.tabled(scene).steady.scene), sized(with_inline_cases(*scene_of(scene)))]
    planned, computed, usual = (periodic_problem(system, 4000.0 * RPM).grid.level.size for system in systems)
    assert planned == pytest.approx(computed, rel=0.1)
    assert usual < 0.7 * computed


def test_a_deflection_before_a_search_is_planned_as_its_stage(tmp_path):
    """Over the face the misalignment of a mesh follows from a deflection, which has stages of its own."""
    scene, _ = scene_of(EXAMPLES / "flexible_shafts_scene.toml")
    (tmp_path / "case.toml").write_text(spur_case(torques=[100.0], model="3d"))
    case = read_model(Case, tmp_path / "case.toml")
    mesh = scene.meshes[0].model_copy(update={"case": case, "case_file": None})
    scene, study = scene.model_copy(update={"meshes": (mesh,)}), STUDIES["optimize"]
    heard = {"speed_rpm": [500.0, 900.0], "orders": 2, "bearing": "output left"}
    inputs = validated(
        study.inputs, {"variables": {"pinion": {"profile_crowning_um": [0.0, 20.0]}}, "heard": heard}
    )
    cost = study.run.predicted(scene, inputs, None)
    planned = {part.name: part.stage for part in cost.parts}
    assert planned["deflections"] == planned["tables by misalignment"] == "deflection"
    assert set(planned.values()) <= {name for name, _ in study.stages}


def test_a_deflection_before_a_search_is_reported_as_its_stage(monkeypatch, tmp_path):
    """By the planned cost of its own stages."""
    plan = StudyCost((Work("bodies", 1.0, stage="deflection"), Work("tables", 3.0, stage="flanks")))

    def compute(_subject: Any, _inputs: Any, means: Means) -> Any:
        for stage, fraction in (("deflection", 1.0), ("flanks", 0.5), ("flanks", 1.0)):
            means.report(stage, fraction)
        return SimpleNamespace(deflection=SimpleNamespace(cases=[]))

    deflect = SimpleNamespace(predicted=lambda *_: plan, compute=compute, failure=lambda _: "")
    monkeypatch.setattr(sound_search, "DEFLECT", deflect)
    table = SimpleNamespace(metadata=SimpleNamespace(receipt={"plan": {"model": "3d"}}))
    mesh: Any = SimpleNamespace(name="mesh", misalignment=0.0)
    subject: Any = SimpleNamespace(
        databases={"mesh": table}, scene=SimpleNamespace(meshes=(mesh,)), inputs=None
    )
    reported: list[tuple[str, float]] = []
    means = Means(tmp_path, lambda *progress: reported.append(progress))
    question: Any = SimpleNamespace(misalignment_um=None, load_cases=DeflectInputs().load_cases)
    sound_search.misalignments(subject, mesh, question, means)
    assert reported == [("deflection", 0.25), ("deflection", 0.625), ("deflection", 1.0)]
