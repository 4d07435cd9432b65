"""What follows from a row of the registry, what a study takes, and answers that are as declared."""

import json
from inspect import signature
from pathlib import Path
from typing import Any

import pytest
from study_service import prepared

from fe_contact import analyze
from lineofaction.client import LineOfActionClient
from lineofaction.client.offers import offers
from lineofaction.gearbox.convert.answers import metadata_json, summary_json
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.convert.outline import outline_json
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.from_rexs.unit_answer import unit_json
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES, study_of
from lineofaction.gearbox.rexs.files import read_rexs
from lineofaction.gearbox.schemas import Case, read_model
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.outline import OutlineBody
from lineofaction.gearbox.schemas.plan import PlanBody
from lineofaction.gearbox.studies.computation import Computation
from lineofaction.gearbox.studies.deflect import Inputs
from lineofaction.report.document import stored_study
from lineofaction.report.presentation import Presentation, presentation_of
from service.live.work import live_plan
from service.schemas.answers import UnitBody
from service.schemas.examples import CASE
from service.worker.process import default_registry

EVERY = pytest.mark.parametrize("study", STUDIES.values(), ids=list(STUDIES))


@EVERY
def test_it_has_its_parts(study):
    assert issubclass(study.inputs, BoundaryModel)
    assert isinstance(study.run, Computation) and isinstance(presentation_of(study), Presentation)
    assert sum(share for _, share in study.stages) == pytest.approx(1.0)
    assert study_of(study.kind) is study


@EVERY
def test_the_client_has_a_process_that_says_what_it_takes(study):
    with LineOfActionClient("http://127.0.0.1:9") as client:
        process = getattr(client, study.package)
    expected = "study" if study.takes.from_file else "options"
    assert list(signature(process).parameters) == [study.argument, expected]
    assert process.__doc__ == study.description


def test_a_call_that_does_not_fit_is_told_what_would():
    with LineOfActionClient("http://127.0.0.1:9") as client:
        calls: Any = client
        for wrong in (
            lambda: calls.flank({}, 60.0),
            calls.flank.submit,
            lambda: calls.analyze({}, x=1),
        ):
            with pytest.raises(TypeError, match=r"^(flank\(case, \*\*options\)|analyze\(case\)): "):
                wrong()


def test_the_client_has_the_processes_of_the_service_and_no_others():
    processes = default_registry()
    assert list(offers()) == list(processes)
    for name, offer in offers().items():
        subject, *_ = offer.signature.parameters
        known = set(processes[name].inputs.model_fields)
        assert {subject} <= known or (subject == "subject" and {"case", "scene"} <= known)


@EVERY
def test_its_files_are_known_from_those_of_others(study):
    file = study.run.file
    assert file.values
    assert all(stored_study({file.attribute: value, "title": "any"}) is study for value in file.values)
    assert stored_study({file.attribute: "something else"}) is None


UNIT = Path(__file__).parents[3] / "examples" / "two_stage_gearbox.rexs"
ROTOR = UNIT.with_name("jeffcott_scene.toml")


def test_load_cases_of_an_opened_unit_are_those_of_their_file(tmp_path):
    unit = OpenedUnit.of(read_rexs(UNIT))
    body = UnitBody.model_validate(unit_json(unit))
    file = tmp_path / "load_cases.toml"
    file.write_text(unit.files()["load_cases.toml"], encoding="utf-8")
    deflect = offers()["deflect"]
    by_model, by_file = (
        deflect.inputs(body.scene, study) for study in ({"load_cases": body.load_cases}, file)
    )
    assert by_model == json.loads(json.dumps(by_model))
    as_model, as_file = (
        Inputs.model_validate_json(json.dumps({"load_cases": given["load_cases"]}))
        for given in (by_model, by_file)
    )
    assert as_model == as_file
    assert [case["torque_n_m"] for case in by_model["load_cases"]] == [50.0, 80.0, 30.0]


def test_a_path_as_text_is_refused_with_what_to_do():
    with pytest.raises(BadInput, match=r"pathlib\.Path"):
        offers()["deflect"].inputs(ROTOR, "load_cases.toml")


EXAMPLES = Path(__file__).parents[3] / "service" / "page" / "examples"


def through_json(answer: dict[str, Any]) -> Any:
    return json.loads(json.dumps(answer, allow_nan=False))


@pytest.mark.parametrize("name", ["helical_ev_23_67", "industrial_spur_21_59"])
def test_plans_and_drawings_are_as_declared(name, tmp_path):
    case = read_model(Case, EXAMPLES / f"{name}.toml")
    plan = through_json(
        live_plan({"case": case.model_dump(mode="json"), "time_budget_s": None, "cache": str(tmp_path)})
    )
    assert PlanBody.model_validate(plan).model_dump(mode="json", exclude_unset=True) == plan
    drawing = through_json(outline_json(case))
    assert OutlineBody.model_validate(drawing).model_dump(mode="json") == drawing


def test_a_search_has_the_complaint_of_the_case_as_objective_unless_one_is_stated():
    complaint = {"frequency_hz": 800.0, "speed_rpm": 1200.0, "torque_n_m": 0.1}  # 20 teeth: harmonic 2
    search = default_registry()["optimize"]
    answered = prepared(search, case={**CASE, "complaint": complaint})
    assert (answered["objective"]["harmonic"], answered["torque_n_m"]) == (2, [0.1])
    stated = prepared(search, case={**CASE, "complaint": complaint}, objective={"kind": "worst"})
    assert stated["objective"] == {"kind": "worst", "weights": []}


def test_a_plan_has_the_cost_of_the_study_that_is_named(tmp_path):
    question = {"case": CASE, "time_budget_s": None, "cache": str(tmp_path)}
    plan = through_json(live_plan({**question, "study": "optimize"}))
    assert plan["study"]["cpu_seconds"] > 0.0 and "designs at" in plan["study"]["words"]
    assert PlanBody.model_validate(plan).model_dump(mode="json", exclude_unset=True) == plan
    assert "study" not in live_plan(question)
    with pytest.raises(BadInput, match="optimize"):
        live_plan({**question, "study": "deflect"})


TORQUES = [30.0, 60.0, 110.0, 230.0]


@pytest.fixture(scope="module")
def table():
    pair = gear_pair(Case.model_validate(CASE))
    return analyze(pair, torques=TORQUES, level="draft", positions=8, model="plane_strain")


def test_torques_come_back_as_they_were_typed(table):
    """The table holds forces: torque to force and back leaves a last digit."""
    assert table.torque.tolist() != TORQUES
    assert metadata_json(table)["torque_n_m"] == TORQUES
    assert [load["torque_n_m"] for load in summary_json(table)["loads"]] == TORQUES
