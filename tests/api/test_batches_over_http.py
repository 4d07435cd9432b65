"""Batches: one request, many jobs, one job for all of them; all are entered or none."""

import json
from typing import Any

import pytest
from fastapi.testclient import TestClient
from running_service import until
from service_fakes import EXECUTION, REGISTRY

from service.access.key_file import KeyFile
from service.app import create_app
from service.settings import Settings

ENDED = ("successful", "failed", "dismissed")


@pytest.fixture
def http(tmp_path):
    settings = Settings(data_directory=tmp_path, workers=2, queue_limit=6)
    with TestClient(create_app(settings, REGISTRY)) as found:
        yield found


@pytest.fixture
def idle(tmp_path):
    """An app whose scheduler does not run: jobs stay as they are put."""
    return TestClient(create_app(Settings(data_directory=tmp_path, queue_limit=6), REGISTRY))


def submitted(http: TestClient, *wishes: dict[str, Any], name: str | None = None, **shared: Any) -> Any:
    jobs = [{"wish": wish} for wish in wishes]
    headers = {} if name is None else {"Idempotency-Key": name}
    body = {"process": "fake", "inputs": {"wish": shared}, "jobs": jobs}
    return http.post("/v1/batches", json=body, headers=headers)


def ended(http: TestClient, batch: str) -> dict[str, Any]:
    until(lambda: http.get(f"/v1/jobs/{batch}").json()["status"] in ENDED)
    status: dict[str, Any] = http.get(f"/v1/jobs/{batch}").json()
    return status


def children(http: TestClient, batch: str) -> list[dict[str, Any]]:
    found = http.get("/v1/jobs", params={"parent": batch}).json()["jobs"]
    return sorted(found, key=lambda job: job["place"])


def count(http: TestClient) -> int:
    """Return how many jobs there are, those in batches apart."""
    return len(http.get("/v1/jobs").json()["jobs"])


@pytest.mark.law
def test_a_batch_is_a_job_whose_results_are_those_of_its_jobs_in_order(http):
    texts = ["c", "a", "b"]
    answer = submitted(http, *({"text": text} for text in texts))
    assert answer.status_code == 201
    batch = answer.json()
    assert answer.headers["location"] == f"/v1/jobs/{batch['jobID']}"
    assert (batch["processID"], batch["children"], batch["parentID"]) == ("fake", 3, None)
    end = ended(http, batch["jobID"])
    assert (end["status"], end["progress"], end["message"]) == ("successful", 100, "3 of 3 jobs have ended.")
    results = http.get(f"/v1/jobs/{batch['jobID']}/results").json()["jobs"]
    assert [http.get(r["results"]["database"]["href"] + "/file").text for r in results] == texts
    assert [job["jobID"] for job in children(http, batch["jobID"])] == [r["jobID"] for r in results]
    assert [job["place"] for job in children(http, batch["jobID"])] == [0, 1, 2]
    assert {job["parentID"] for job in children(http, batch["jobID"])} == {batch["jobID"]}


def test_each_job_of_a_batch_is_set_apart_from_the_one_before_it(http):
    batch = submitted(http, {"text": "a"}, {"text": "b"}, {"text": "b"}).json()
    first, second, third = children(http, batch["jobID"])
    assert first["differences"]["number"] == 0
    assert second["differences"] == {
        "since": first["jobID"],
        "number": 1,
        "first": [{"field": "wish.text", "before": "a", "value": "b"}],
    }
    assert (third["differences"]["since"], third["differences"]["number"]) == (second["jobID"], 0)
    assert [job["jobID"] for job in http.get("/v1/jobs").json()["jobs"]] == [batch["jobID"]]


def test_jobs_are_differences_from_what_they_share(http):
    batch = submitted(http, {}, {"number": 2.0}, {"text": None}, text="shared", number=1.0).json()["jobID"]
    assert ended(http, batch)["status"] == "successful"
    submissions = http.app.state.context.submissions
    wishes = [json.loads(job.inputs)["wish"] for job in submissions.children(batch)]
    assert [(wish["text"], wish["number"]) for wish in wishes] == [
        ("shared", 1.0),
        ("shared", 2.0),
        ("", 1.0),
    ]


def test_a_failed_job_is_said_and_the_rest_goes_on(http):
    batch = submitted(http, {"text": "a"}, {"mode": "input"}, {"text": "b"}).json()["jobID"]
    end = ended(http, batch)
    assert (end["status"], end["progress"], end["message"]) == (
        "failed",
        99,
        "3 of 3 jobs have ended, 1 failed.",
    )
    results = http.get(f"/v1/jobs/{batch}/results").json()["jobs"]
    assert [result["status"] for result in results] == ["successful", "failed", "successful"]
    (fault,) = results[1]["problem"]["errors"]
    assert fault["field"] == "pair.pinion.bore_diameter_mm" and results[1]["results"] is None
    assert [
        job["jobID"]
        for job in http.get("/v1/jobs", params={"parent": batch, "status": "failed"}).json()["jobs"]
    ]


def test_equal_jobs_and_those_of_others_share_their_computation(http, tmp_path):
    alone = http.post(EXECUTION, json={"inputs": {"wish": {"text": "x"}}}).json()
    batch = submitted(http, {"text": "x"}, {"text": "x"}, {"text": "y"}).json()["jobID"]
    assert ended(http, batch)["status"] == "successful"
    submissions = http.app.state.context.submissions
    jobs = submissions.children(batch)
    assert jobs[0].computation == jobs[1].computation == submissions.find(alone["jobID"]).computation
    assert len({job.id for job in jobs}) == 3
    assert len(list(tmp_path.glob("started_*"))) == 2
    again = submitted(http, {"text": "x"}, {"text": "y"}).json()
    assert (again["status"], again["progress"]) == ("successful", 100)  # all from the store, at once


def test_one_bad_job_keeps_all_out_and_each_is_named(idle):
    answer = submitted(
        idle, {"text": "a"}, {"mode": "refuse"}, {"number": 11.0}, {"other": 1, "number": -1.0}
    )
    assert answer.status_code == 422
    fields = [fault["field"] for fault in answer.json()["errors"]]
    assert fields == ["jobs[1].mode", "jobs[2].wish.number", "jobs[3].wish.number", "jobs[3].wish.other"]
    assert count(idle) == 0
    everywhere = submitted(idle, *({"number": -1.0, "mode": "odd"} for _ in range(60)))
    named = {fault["field"].partition(".")[0] for fault in everywhere.json()["errors"]}
    assert named == {f"jobs[{index}]" for index in range(60)}


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({"process": "other", "jobs": [{}]}, "process"),
        ({"process": "fake", "jobs": []}, "jobs"),
        ({"process": "fake", "jobs": [{}] * 201}, "jobs"),
        ({"process": "fake", "jobs": [1]}, "jobs[0]"),
        ({"process": "fake", "jobs": [{}], "inputs": []}, "inputs"),
        ({"process": "fake", "jobs": [{}], "odd": 1}, "odd"),
        ({"jobs": [{}]}, "process"),
    ],
)
def test_what_is_no_batch_is_refused_by_name(idle, body, field):
    answer = idle.post("/v1/batches", json=body)
    assert answer.status_code == 422
    assert field in [fault["field"] for fault in answer.json()["errors"]]


def test_deep_differences_are_refused_as_others(idle):
    deep: Any = 1
    for _ in range(300):
        deep = {"wish": deep}
    answer = idle.post("/v1/batches", json={"process": "fake", "inputs": deep, "jobs": [deep]})
    assert answer.status_code == 422


def test_the_limits_count_the_jobs_in_batches(idle, tmp_path):
    never = submitted(idle, *({"number": n / 10} for n in range(7)))
    assert (never.status_code, never.json()["errors"][0]["field"]) == (422, "jobs")
    assert submitted(idle, *({"number": n / 10} for n in range(4))).status_code == 201
    full = submitted(idle, *({"number": 1 + n / 10} for n in range(3)))
    assert (full.status_code, full.json()["type"]) == (429, "urn:lineofaction:problem:queue-full")
    assert count(idle) == 1
    shared = submitted(
        idle, {"number": 0.0}, {"number": 0.1}, {"number": 2.0}, {"number": 2.0}, {"number": 2.1}
    )
    assert shared.status_code == 201  # two new computations


def test_the_limit_of_a_key_counts_the_jobs_in_batches(tmp_path):
    key = KeyFile(tmp_path / "keys.json").add("bench", unfinished_jobs=3)
    http = TestClient(create_app(Settings(data_directory=tmp_path), REGISTRY))
    http.headers["Authorization"] = f"Bearer {key}"
    assert submitted(http, *({"number": n / 10} for n in range(4))).status_code == 422
    assert submitted(http, {"number": 0.1}, {"number": 0.2}).status_code == 201
    assert submitted(http, {"number": 0.3}, {"number": 0.4}).status_code == 429
    assert submitted(http, {"number": 0.3}).status_code == 201
    assert submitted(http, {"number": 0.4}).status_code == 429


def test_the_same_request_is_the_same_batch(idle):
    wishes = [{"number": 0.1}, {"number": 0.2}]
    first, again = submitted(idle, *wishes, name="one"), submitted(idle, *wishes, name="one")
    assert first.json()["jobID"] == again.json()["jobID"] and count(idle) == 1
    assert submitted(idle, *wishes, name="other").json()["jobID"] != first.json()["jobID"]
    refused = submitted(idle, *wishes[::-1], name="one")
    assert (refused.status_code, refused.json()["errors"][0]["field"]) == (422, "Idempotency-Key")
    assert count(idle) == 2


def test_dismissal_of_a_batch_is_that_of_its_jobs(http):
    done = submitted(http, {"text": "kept"}).json()["jobID"]
    ended(http, done)
    alone = http.post(EXECUTION, json={"inputs": {"wish": {"text": "o", "mode": "hang"}}})
    wishes = [{"text": "kept"}, {"mode": "hang"}, {"mode": "hang", "text": "o"}]
    batch = submitted(http, *wishes).json()["jobID"]
    assert http.delete(f"/v1/jobs/{batch}").json()["status"] == "dismissed"
    assert [job["status"] for job in children(http, batch)] == ["successful", "dismissed", "dismissed"]
    results = http.get(f"/v1/jobs/{batch}/results").json()["jobs"]
    assert [result["status"] for result in results] == ["successful", "dismissed", "dismissed"]
    assert http.get(alone.headers["location"]).json()["status"] in ("accepted", "running")
    http.delete(alone.headers["location"])
    counts = http.app.state.context.submissions.counts
    until(lambda: not {"accepted", "running"} & set(counts()))


def test_a_batch_whose_jobs_are_dismissed_one_by_one_ends(http):
    batch = submitted(http, {"text": "a"}, {"mode": "hang"}).json()["jobID"]
    http.delete(f"/v1/jobs/{children(http, batch)[1]['jobID']}")
    end = ended(http, batch)
    assert (end["status"], end["message"]) == ("dismissed", "2 of 2 jobs have ended, 1 dismissed.")


def test_events_tell_of_the_whole_and_progress_never_falls(http):
    batch = submitted(http, {"mode": "slow", "text": "a"}, {"mode": "die_once"}, {"text": "b"}).json()[
        "jobID"
    ]
    lines = http.get(f"/v1/jobs/{batch}/events").text.splitlines()
    states = [json.loads(line[6:]) for line in lines if line.startswith("data: ")]
    progress = [state["progress"] for state in states]
    assert progress == sorted(progress) and progress[-1] == 100
    assert any(0 < value < 100 for value in progress)  # how many are seen in between, a busy machine decides
    assert states[-1]["status"] == "successful"


def test_results_of_a_batch_wait_for_its_last_job(idle):
    batch = submitted(idle, {"text": "a"}).json()["jobID"]
    answer = idle.get(f"/v1/jobs/{batch}/results")
    assert (answer.status_code, answer.json()["title"]) == (404, "The result is not ready")
