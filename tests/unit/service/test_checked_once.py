"""A process validates, converts and checks a case once on its way from the body to the contact solver."""

import json
import sys
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import ExitStack
from typing import Any

import pytest
from command_line import loa
from fastapi.testclient import TestClient

import lineofaction
from fe_contact.analysis.request import request_check
from lineofaction.gearbox.convert import case as conversion
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.plan import plan_of
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.toml import toml_text
from lineofaction.gearbox.studies import scene_before_tables
from service.app import create_app
from service.page.example_cases import examples
from service.schemas.execute import AnalyzeInputs
from service.settings import Settings
from service.store.places import stored_results
from service.worker import expectations, preparations
from service.worker.child import stamp_products
from service.worker.order import WorkOrder
from service.worker.preparations import name_database, prepare_analyze
from service.worker.simulation_work import analyze_case

GEAR = {"teeth": 20, "face_width_mm": 2.0, "bore_diameter_mm": 10.0}
CASE: dict[str, Any] = {
    "pair": {"normal_module_mm": 1.0, "center_distance_mm": 20.0, "pinion": GEAR, "wheel": GEAR},
    "load": {"torque_n_m": [0.1]},
    "accuracy": {"level": "draft", "positions": 8, "model": "plane_strain"},
}
STUDY = {
    "variables": {"pinion": {"tip_relief_um": [0.0, 2.0], "tip_relief_length_mm": [0.2, 0.6]}},
    "search": {"starts": 1, "evaluations": 4, "positions": 16},
}


class Calls:
    """What a process did to its cases: validated from JSON, converted, checked."""

    def __init__(self) -> None:
        self.validated, self.converted = 0, 0
        self.checked: list[str] = []

    @property
    def counts(self) -> tuple[int, int, int]:
        return self.validated, self.converted, len(self.checked)


@pytest.fixture
def calls(monkeypatch):
    calls = Calls()
    convert, check, validate = conversion.gear_pair, request_check.check_request, Case.model_validate_json

    def converted(case):
        calls.converted += 1
        return convert(case)

    def checked(*request, **limits):
        calls.checked.append(repr(request))
        return check(*request, **limits)

    def read(text):
        calls.validated += 1
        return validate(text)

    monkeypatch.setattr(Case, "model_validate_json", read)
    for cases in (preparations.CASES, scene_before_tables.CASES):
        monkeypatch.setattr(cases, "_cases", type(cases)()._cases)
    _replace(monkeypatch, "gear_pair", convert, converted)
    _replace(monkeypatch, "check_request", check, checked)
    yield calls


def _replace(
    monkeypatch: pytest.MonkeyPatch, name: str, function: Callable[..., Any], other: Callable[..., Any]
) -> None:
    for module in list(sys.modules.values()):
        if getattr(module, "__dict__", {}).get(name) is function:
            monkeypatch.setattr(module, name, other)


@pytest.fixture
def file(tmp_path):
    file = tmp_path / "case.toml"
    file.write_text(toml_text(CASE), encoding="utf-8")
    return file


def invoked(*arguments: object) -> None:
    done = loa(*arguments)
    assert done.exit_code == 0, done.output


def _planned(_order: object, _asker: object) -> Future[bytes]:
    answer: Future[bytes] = Future()
    answer.set_result(json.dumps({"prediction": {"stages": {"contact": 1.0}}}).encode())
    return answer


def test_a_submission_with_a_cost_limit_checks_once_in_the_server(calls, tmp_path, monkeypatch):
    """Its warnings and its predicted cost are of that check; the plan is made in a process of its own."""
    app = create_app(Settings(data_directory=tmp_path))
    body = {"inputs": {"case": CASE}, "max_cost_s": 1e4}
    with ExitStack() as end:
        end.callback(app.state.context.close)
        end.callback(app.state.context.stop_waiting)
        monkeypatch.setattr(app.state.context.live, "ask", _planned)
        client = TestClient(app)
        status = client.post("/v1/processes/analyze/execution", json=body)
        assert status.status_code == 201, status.text
        assert client.get(f"/v1/jobs/{status.json()['jobID']}").json()["warnings"] == []
    assert calls.counts == (0, 1, 1)
    assert expectations.predicted_seconds({"case": validated(Case, CASE).model_dump(mode="json")})
    assert calls.counts == (0, 1, 1)


def test_a_worker_reads_and_checks_its_case_once(calls, tmp_path):
    inputs = {"case": validated(Case, CASE).model_dump(mode="json")}
    order = WorkOrder("", inputs, "key", tmp_path, tmp_path)
    stamp_products(order, analyze_case(order, lambda *_: None))
    assert calls.counts == (1, 1, 1)


def test_the_command_line_checks_once(calls, file, tmp_path):
    invoked("analyze", file, "-o", tmp_path / "ste.nc")
    assert calls.counts == (0, 1, 1)


def test_python_checks_once(calls):
    lineofaction.analyze(validated(Case, CASE))
    assert calls.counts == (0, 1, 1)


def test_a_plan_checks_once(calls, file):
    invoked("plan", file)
    assert calls.counts == (0, 1, 1)


def test_a_tolerance_goes_on_from_the_check_of_the_submission(calls):
    """What it does not need is decided as where the request is checked at once."""
    table = CASE | {"accuracy": {"tolerance": 0.3}}
    submitted, direct = (CheckedCase(validated(Case, table)) for _ in range(2))
    assert submitted.feasible.request.neglected == {}
    assert submitted.checked.request.neglected == direct.checked.request.neglected
    assert submitted.checked.ledger == direct.checked.ledger
    assert calls.counts == (0, 2, 2)


@pytest.mark.law
def test_an_optimization_checks_its_request_once(calls, file, tmp_path):
    """That of its maps, whose torques are more than its own."""
    (tmp_path / "study.json").write_text(json.dumps(STUDY))
    invoked("optimize", file, tmp_path / "study.json", "-o", tmp_path / "best")
    assert calls.converted == 1
    assert len(calls.checked) == 1


def test_a_sweep_checks_once(calls, file, tmp_path):
    invoked("sweep", file, "--over", "torque=0.1:0.2:0.1", "-o", tmp_path / "map.nc")
    assert calls.counts == (0, 1, 1)


@pytest.mark.parametrize(
    ("verb", "target"), [("flank", "flanks.nc"), ("root-stress", "roots.json"), ("export", "bodies")]
)
def test_results_at_a_point_check_once(calls, file, tmp_path, verb, target):
    """Flanks, roots and deformed gears go on from the check that refuses what cannot be."""
    invoked(verb, file, "-o", tmp_path / target)
    assert calls.counts == (0, 1, 1)


def test_a_plan_goes_on_from_the_check_of_the_submission(calls):
    case = CheckedCase(validated(Case, CASE))
    assert case.feasible.request.pair == plan_of(case, None, None).checked.request.pair
    assert calls.counts == (0, 1, 1)


def inputs(torque_n_m: float) -> AnalyzeInputs:
    """Return a case that differs by its largest torque."""
    case: dict[str, Any] = {**examples()[0].content, "load": {"torque_n_m": [50.0, torque_n_m]}}
    return AnalyzeInputs.model_validate({"case": case})


def test_a_case_is_checked_until_its_table_is_stored(tmp_path, monkeypatch):
    class Refused:
        @property
        def feasible(self):
            raise BadInput.of("case", None, "never checked")

    store, known = stored_results(tmp_path), inputs(100.0)
    normalized = prepare_analyze(known, store)
    assert normalized == known.model_dump(mode="json")
    monkeypatch.setattr(preparations.CASES, "of", lambda _case: Refused())
    with pytest.raises(BadInput):
        prepare_analyze(known, store)
    (tmp_path / "table.nc").write_bytes(b"a table")
    store.put(name_database(normalized), "database", tmp_path / "table.nc")
    assert prepare_analyze(known, store) == normalized
    with pytest.raises(BadInput):
        prepare_analyze(inputs(101.0), store)
