"""Live curves and plans over HTTP: those of a whole analysis, and clear refusals."""

import html
import json
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from running_service import PATIENCE_S, REFERENCES, until

from fe_contact import AnalysisOptions, OperatingPoint, flank_results
from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.problems import ServiceError
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.live_answer import LiveOutput
from lineofaction.gearbox.schemas.reading import validated
from service.app import create_app
from service.live.order import LiveOrder
from service.routes.queries import STE
from service.settings import Settings

GEAR: dict[str, Any] = {"teeth": 20, "face_width_mm": 4.0, "bore_diameter_mm": 10.0}
RELIEF = {"tip_relief_um": 3.0, "tip_relief_length_mm": 0.4}


def case(**pinion: Any) -> dict[str, Any]:
    gears = {"pinion": GEAR | pinion, "wheel": GEAR}
    return {
        "pair": {"normal_module_mm": 1.0, "center_distance_mm": 20.0, **gears},
        "load": {"torque_n_m": [0.5, 1.0]},
        "accuracy": {"level": "draft", "model": "plane_strain", "positions": 192, "receipt": "minimal"},
        "effects": {"corner_contact": "on"},
    }


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    with TestClient(create_app(Settings(data_directory=tmp_path_factory.mktemp("service")))) as found:
        yield found


def analyzed(client: TestClient, asked: dict[str, Any]) -> str:
    """Return the hash of the table of a case, computed as a job."""
    job = client.post("/v1/processes/analyze/execution", json={"inputs": {"case": asked}}).json()
    where = f"/v1/jobs/{job['jobID']}"
    until(lambda: client.get(where).json()["status"] not in ("accepted", "running"))
    assert (status := client.get(where).json())["status"] == "successful", status
    return str(client.get(f"/v1/jobs/{job['jobID']}/results", params=REFERENCES).json()["database"]["hash"])


@pytest.fixture(scope="module")
def key(client):
    return analyzed(client, case())


@pytest.mark.law
def test_a_live_curve_is_that_of_an_analysis_of_its_own(client, key):
    live = client.post(f"/v1/databases/{key}/ste", json={"torque_n_m": [0.5, 1.0], "pinion": RELIEF}).json()
    store = client.app.state.context.store
    other = analyzed(client, case(**RELIEF))
    table = client.app.state.context.databases.get(store, other).database
    for curve in live["curves"]:
        whole = table.curve(torque=curve["torque_n_m"])
        assert curve["ste_um"] == pytest.approx((1e6 * whole.ste).tolist(), rel=1e-12, abs=0.0)
        assert curve["peak_to_peak_um"] == pytest.approx(1e6 * whole.peak_to_peak.value, rel=1e-12, abs=0.0)
    assert live["effects"]["profile_modification"] and live["beyond_load_patches"] == 0


def test_figures_that_were_drawn_once_need_no_live_worker(client, key, monkeypatch):
    where = f"/v1/results/{key}/figures"
    drawn = client.get(where)
    assert [section["title"] for section in drawn.json()["sections"]]
    monkeypatch.setattr(type(client.app.state.context.live), "ask", None)
    again = client.get(where)
    assert again.content == drawn.content
    assert again.headers["ETag"] == drawn.headers["ETag"]
    assert client.get(where, headers={"If-None-Match": drawn.headers["ETag"]}).status_code == 304


def test_two_results_are_compared_as_figures(client, key):
    """With itself, nothing differs; with the relieved pair, the relief is named."""
    where = f"/v1/results/{key}/figures"
    itself = client.get(where, params={"against": key}).json()
    assert {line["remark"] for line in itself["headlines"]} <= {"not shown to differ", "no error stated"}
    other = analyzed(client, case(**RELIEF))
    page = client.get(where, params={"against": other}).json()
    (fields,) = (
        table for section in page["sections"] for table in section["tables"] if "Fields" in table["caption"]
    )
    assert ["pair.pinion.tip_relief_um", "0", "3"] in fields["rows"]
    assert client.get(where, params={"against": "0" * 64}).status_code == 404
    assert client.get(where, params={"against": "nonsense"}).status_code == 422


def test_a_report_to_print_is_a_page_in_which_nothing_runs(client, key):
    """As a browser's address bar sends it; program and page of one result have tags of their own."""
    where, typed = f"/v1/results/{key}/figures", "text/html,application/xhtml+xml,*/*;q=0.8"
    for query in ({}, {"against": key}):
        page = client.get(where, params=query, headers={"Accept": typed})
        assert page.headers["Content-Type"] == "text/html; charset=utf-8"
        figures = client.get(where, params=query)
        assert figures.headers["Content-Type"] == "application/json"
        titles = [figure["title"] for section in figures.json()["sections"] for figure in section["figures"]]
        assert titles and all(html.escape(title) in page.text for title in titles)
        assert page.text.count('src="data:image/png;base64,') == len(titles) and "<script" not in page.text
        policy = page.headers["Content-Security-Policy"]
        assert policy.startswith("sandbox;") and "default-src 'none'" in policy and "script" not in policy
        for answer in (page, figures):
            assert answer.headers["Vary"] == "Accept"
            tag = {"If-None-Match": answer.headers["ETag"]}
            same, other = ({"Accept": kind} | tag for kind in (typed, "application/json"))
            own = client.get(where, params=query, headers=same).status_code
            assert {own, client.get(where, params=query, headers=other).status_code} == {200, 304}


def test_a_preview_states_no_errors_and_has_every_other_position(client, key):
    question = {"torque_n_m": [1.0], "pinion": RELIEF, "flanks": True, "passage": True}
    answers = [
        client.post(f"/v1/databases/{key}/ste", json=question | {"preview": preview}).json()
        for preview in (True, False)
    ]
    (quick,), (whole,) = (answer["curves"] for answer in answers)
    assert quick["ste_um"] == pytest.approx(whole["ste_um"][::2], rel=1e-12, abs=0.0)
    assert "mean_error_um" not in quick and "mean_error_um" in whole and quick["error_by_source_um"] == {}
    assert answers[0]["discretisation_error"] is None and "position" in answers[0]["not_estimated"]
    assert set(quick["flanks"]) == set(whole["flanks"])


@pytest.mark.law
def test_pairs_within_a_class_are_solved_in_parts_and_spread_more_in_a_coarser_class(client, key):
    width = {}
    for chosen in (4, 8):
        question = {"torque_n_m": [1.0], "preview": True, "tolerance_class": chosen}
        answers = [client.post(f"/v1/databases/{key}/ste", json=question).json() for _ in range(5)]
        LiveOutput.model_validate_json(json.dumps(answers[-1]))
        bands = [answer["curves"][0]["band"] for answer in answers]
        assert [band["solved"] for band in bands] == [4, 8, 12, 16, 16]
        assert bands[3] == bands[4] and "peak_to_peak" not in bands[2]
        assert answers[4]["cost"]["band_cpu_seconds"] < 0.5 * answers[1]["cost"]["band_cpu_seconds"]
        assert bands[4]["position"] == answers[4]["curves"][0]["position"]
        spread = bands[4]["peak_to_peak"]
        width[chosen] = spread["high_um"] - spread["low_um"]
    assert width[8] > 2.0 * width[4]


@pytest.mark.parametrize("chosen", [0, 12, 6.5, "six", True, [6], {"tolerance_class": 6}, 1e9, -1])
def test_a_class_that_is_none_is_refused(client, key, chosen):
    refused = client.post(f"/v1/databases/{key}/ste", json={"torque_n_m": [1.0], "tolerance_class": chosen})
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["field"].startswith("tolerance_class")


def test_pairs_are_drawn_at_one_torque(client, key):
    question = {"torque_n_m": [0.5, 1.0], "tolerance_class": 6}
    refused = client.post(f"/v1/databases/{key}/ste", json=question)
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["field"] == "tolerance_class"


def test_an_answer_knows_how_wrong_it_is_and_what_it_cost(client, key):
    questions = [{"torque_n_m": [0.5, 1.0], "pinion": RELIEF | {"tip_relief_um": x}} for x in (4.0, 5.0)]
    first, again = (client.post(f"/v1/databases/{key}/ste", json=question).json() for question in questions)
    for curve in again["curves"]:
        assert 0.0 < curve["peak_to_peak_error_um"] < 0.2 * curve["peak_to_peak_um"]
        assert 0.0 < curve["mean_error_um"] < 0.08 * curve["mean_um"]  # plane strain was requested
        assert len(curve["harmonics_error_um"]) == len(curve["harmonics_um"])
        by_source = curve["error_by_source_um"].values()
        total = sum(source["peak_to_peak"] ** 2 for source in by_source) ** 0.5
        assert curve["peak_to_peak_error_um"] == pytest.approx(total, rel=1e-9, abs=0.0)
    assert again["discretisation_error"] == "expected"  # the table has a minimal receipt
    assert again["not_estimated"] == [] and 0.0 < again["residuals_max"] < 1e-6
    assert {one["assumption"]: one["holds"] for one in again["assumptions"]} == {
        "uniform load over the face": True,
        "plane strain over the whole face": False,  # as requested by name
        "contact strips within the load patches": True,
    }
    assert [one["assumption"] for one in again["not_checked"]] == ["coast flanks stay apart"]
    assert sum(again["cost"].values()) <= again["cpu_seconds"]
    assert again["cost"]["compliance_cpu_seconds"] < 0.5 * sum(again["cost"].values())
    LiveOutput.model_validate_json(json.dumps(first))


def test_a_passage_meets_what_all_pairs_carry(client, key):
    question = {"torque_n_m": [0.5, 1.0], "pinion": RELIEF, "flanks": True, "passage": True}
    answer = client.post(f"/v1/databases/{key}/ste", json=question).json()
    LiveOutput.model_validate_json(json.dumps(answer))
    assert answer["cost"]["passage_cpu_seconds"] > 0.0
    for curve in answer["curves"]:
        passage, shares = curve["passage"], np.array(curve["load_share"])
        pressure = np.array(passage["pressure_mpa"])[:, 0]
        place = passage["first_place"] + passage["step"] * np.arange(pressure.size)
        maximum = max(curve["flanks"]["largest_pressure_mpa"], curve["flanks"]["edge_pressure_mpa"])
        assert pressure.max() == pytest.approx(maximum, rel=0.03)
        # a pair carries where it meets pressure: at every position, by its place
        at = np.array(curve["position"])[:, None] + np.array(curve["pair"])
        met = np.interp(at, place, pressure, left=0.0, right=0.0)
        assert np.array_equal(met[shares > 0.02] > 0.0, np.ones(np.sum(shares > 0.02), dtype=bool))
        assert met[(shares == 0.0) & (np.abs(at) > 1.5)].max(initial=0.0) == 0.0
        apart = np.array(passage["apart_um"])[:, 0]
        assert 0.0 < apart[pressure > 0].mean() < curve["mean_um"]  # the rest is the approach of the flanks


def test_the_flanks_of_an_answer_are_those_of_the_study_of_flanks(client, key):
    question = {"torque_n_m": [0.5, 1.0], "pinion": RELIEF}
    plain, full = (
        client.post(f"/v1/databases/{key}/ste", json=question | more).json()
        for more in ({}, {"flanks": True})
    )
    assert all("flanks" not in curve for curve in plain["curves"])
    assert full["cost"]["flanks_cpu_seconds"] > 0.0 and "flanks_cpu_seconds" not in plain["cost"]
    pair = gear_pair(validated(Case, case(**RELIEF)))
    options = AnalysisOptions(level="draft", model="plane_strain", effects={"corner_contact": "on"})
    for curve in full["curves"]:
        found = curve["flanks"]
        point = OperatingPoint(torque=curve["torque_n_m"])
        whole = flank_results(pair, point, options, at=np.array(curve["position"]))
        assert found["largest_pressure_mpa"] == pytest.approx(
            1e-6 * float(whole.clear_pressure.max()), rel=1e-9
        )
        drawn = max(found["largest_pressure_mpa"], found["edge_pressure_mpa"])
        assert np.max(found["pressure_mpa"]) == pytest.approx(drawn, rel=0.05)
        assert found["mean_load_n_per_mm"] == pytest.approx(
            (1e-3 * whole.face_load.mean(axis=0)).tolist(), rel=1e-4
        )
        assert found["k_h_beta"] is None  # in the plane
    LiveOutput.model_validate_json(json.dumps(full))


def test_a_live_center_distance_is_that_of_an_analysis_of_its_own(client, key):
    question = {"torque_n_m": [1.0], "center_distance_change_mm": 0.05, "pinion": RELIEF}
    (curve,) = client.post(f"/v1/databases/{key}/ste", json=question).json()["curves"]
    asked = case(**RELIEF) | {"errors": {"center_distance_change_mm": [0.05]}}
    context = client.app.state.context
    table = context.databases.get(context.store, analyzed(client, asked)).database
    whole = table.curve(torque=1.0, center_distance_change=0.05e-3)
    assert curve["center_distance_change_mm"] == 0.05
    assert curve["ste_um"] == pytest.approx((1e6 * whole.ste).tolist(), rel=1e-12, abs=0.0)


def test_derivatives_are_the_changes_of_the_curve_in_the_units_of_the_question(client, key):
    def curve(relief, torque, **more):
        question = {"torque_n_m": [torque], "pinion": RELIEF | {"tip_relief_um": relief}, **more}
        found = client.post(f"/v1/databases/{key}/ste", json=question).json()
        assert ("derivatives_cpu_seconds" in found["cost"]) == bool(more)
        return dict(found["curves"][0])

    found = curve(3.0, 0.8, derivatives=True)["derivatives"]
    step = 1e-3
    for name, above, below, width in (
        ("pinion.tip_relief_um", curve(3.0 + step, 0.8), curve(3.0 - step, 0.8), 2.0 * step),
        ("torque_n_m", curve(3.0, 0.8 + step), curve(3.0, 0.8 - step), 2.0 * step),
    ):
        for field in ("mean_um", "peak_to_peak_um"):
            change = (above[field] - below[field]) / width
            assert found["by"][name][field] == pytest.approx(change, rel=0.01, abs=1e-3)
    assert "wheel.helix_crowning_um" not in found["by"]  # a plane case
    pinion = found["pinion"]
    assert np.shape(pinion["mean_um"]) == (len(pinion["roll_length_mm"]), len(pinion["face_position_mm"]))
    # removed everywhere it is what the gears lag, but for tip edges, which close it by their lever arms
    assert np.sum(pinion["mean_um"]) == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize(
    ("question", "field"),
    [
        ({"torque_n_m": [2.5]}, "torque_n_m[0]"),
        ({"torque_n_m": [1.0, 0.5]}, "torque_n_m"),
        ({"torque_n_m": [1.0], "misalignment_um": 5.0}, "misalignment_um"),
        ({"torque_n_m": [1.0], "center_distance_change_mm": 3.0}, "center_distance_change_mm"),
        ({"torque_n_m": [1.0], "wheel": {"helix_crowning_um": 2.0}}, "wheel.helix_crowning_um"),
        ({"torque_n_m": [1.0], "wheel": {"tip_relief_um": 2.0}}, "wheel.tip_relief_length_mm"),
        ({"torque_n_m": [1.0], "wheel": {"teeth": 21}}, "wheel.teeth"),
        ({"torque_n_m": [1.0], "pinion": {"tip_relief_um": -1.0}}, "pinion.tip_relief_um"),
    ],
)
def test_a_question_that_cannot_be_answered_names_its_field(client, key, question, field):
    refused = client.post(f"/v1/databases/{key}/ste", json=question)
    assert refused.status_code == 422
    assert refused.headers["content-type"] == "application/problem+json"
    assert [fault["field"] for fault in refused.json()["errors"]] == [field]


def test_a_table_that_is_unknown_or_removed_is_not_found(client, key):
    question = {"torque_n_m": [1.0]}
    unknown = client.post(f"/v1/databases/{'0' * 64}/ste", json=question)
    assert unknown.status_code == 404 and "Submit its case" in unknown.json()["detail"]
    context = client.app.state.context
    inputs = {"key": key, "file": "/removed", "cache": "/none", "question": question}
    assert client.post(f"/v1/databases/{key}/ste", json=question).status_code == 200
    known = context.live.ask(LiveOrder(STE, inputs)).result(timeout=PATIENCE_S)
    assert len(json.loads(known)["curves"]) == 1  # from memory
    context.live.stop()
    context.live.start()
    with pytest.raises(ServiceError, match="removed from the store") as gone:
        context.live.ask(LiveOrder(STE, inputs)).result(timeout=PATIENCE_S)
    assert gone.value.as_json()["status"] == 404


def test_a_table_computed_elsewhere_is_condensed_here_when_asked_to(client, key, tmp_path):
    """Another service with the same database and results, and a cache of its own."""
    question = {"torque_n_m": [0.5, 1.0], "pinion": RELIEF}
    known = client.post(f"/v1/databases/{key}/ste", json=question).json()
    folder = client.app.state.context.settings.data_directory
    settings = Settings(
        data_directory=tmp_path,
        database_url=f"sqlite:///{folder / 'service.sqlite3'}",
        results_url=(folder / "results").as_uri(),
    )
    with TestClient(create_app(settings, works=False)) as other:
        refused = other.post(f"/v1/databases/{key}/ste", json=question)
        assert (refused.status_code, refused.json()["type"]) == (409, "urn:lineofaction:problem:not-analysed")
        assert "condense = true" in refused.json()["detail"]
        with LineOfActionClient(transport=other._transport, cache_dir=tmp_path / "client") as asker:
            found = asker.ste(key, [0.5, 1.0], pinion=RELIEF, condense=True)
        again = other.post(f"/v1/databases/{key}/ste", json=question).json()
    assert found.discretisation_error == again["discretisation_error"] == "measured"
    assert again["cost"]["compliance_cpu_seconds"] < 0.5 * found.cost.compliance_cpu_seconds
    for curve, there, later in zip(found.curves, known["curves"], again["curves"], strict=True):
        assert curve.ste_um == later["ste_um"] == pytest.approx(there["ste_um"], rel=1e-9, abs=0.0)
        assert curve.peak_to_peak_error_um == later["peak_to_peak_error_um"]
        assert curve.peak_to_peak_error_um is not None and curve.peak_to_peak_error_um > 0.0


def test_a_plan_is_that_of_the_command_line(client):
    found = client.post("/v1/plans", json={"inputs": {"case": case()}}).json()
    assert [entry["level"] for entry in found["levels"]] == ["draft", "standard", "fine"]
    assert found["choice"]["level"] == "draft"
    assert {"corner_contact", "misalignment"} <= {entry["name"] for entry in found["effect_ledger"]}


def test_a_plan_of_no_pair_names_the_field_as_an_execution_does(client):
    asked = {"inputs": {"case": case(bore_diameter_mm=19.0)}}
    refused, as_job = (
        client.post(path, json=asked) for path in ("/v1/plans", "/v1/processes/analyze/execution")
    )
    assert refused.status_code == as_job.status_code == 422
    assert refused.json() == as_job.json()
    draft = client.post("/v1/drafts/plan", json=asked)
    assert draft.status_code == 200, "what is being typed is no error"
    assert draft.json() == {"detail": as_job.json()["detail"], "faults": as_job.json()["errors"]}
    for question in ("to-toml", "as-made"):
        incomplete = {"inputs": {"case": case(teeth=None)}}
        refused, draft = (client.post(f"/v1/{of}/{question}", json=incomplete) for of in ("cases", "drafts"))
        assert (refused.status_code, draft.status_code) == (422, 200), question
        assert draft.json() == {"detail": refused.json()["detail"], "faults": refused.json()["errors"]}
    typo = client.post("/v1/plans", json={"inputs": {"case": case(teth=3)}}).json()
    assert [fault["field"] for fault in typo["errors"]] == ["pair.pinion.teth"]
