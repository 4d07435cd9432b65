"""Titles and tags of jobs: kept, shown everywhere, searched, changed; on each database."""

from typing import Any

import pytest
from fastapi.testclient import TestClient
from service_fakes import EXECUTION, REGISTRY
from typer.testing import CliRunner

from lineofaction.cli.commands import app as command
from lineofaction.client import LineOfActionClient
from service.access.key_file import KeyFile
from service.app import create_app
from service.settings import Settings


@pytest.fixture
def client(tmp_path, database_url):
    """A client of an app whose scheduler does not run, on each database."""
    app = create_app(Settings(data_directory=tmp_path, database_url=database_url), REGISTRY)
    yield TestClient(app)
    app.state.context.close()


def entered(client: TestClient, **terms: Any) -> Any:
    return client.post(EXECUTION, json={"inputs": {"wish": {}}, **terms})


def listed(client: TestClient, **wanted: Any) -> list[str]:
    """Return the titles of a list of jobs, the newest first."""
    answer = client.get("/v1/jobs", params=wanted)
    assert answer.status_code == 200, answer.text
    return [job["title"] for job in answer.json()["jobs"]]


def test_a_label_is_in_status_list_and_events(client):
    job = entered(client, title="  Tip relief 20 µm ", tags=["EV-3", "draft", "ev-3"]).json()
    assert (job["title"], job["tags"]) == ("Tip relief 20 µm", ["ev-3", "draft"])
    path = f"/v1/jobs/{job['jobID']}"
    (shown,) = client.get("/v1/jobs").json()["jobs"]
    for status in (client.get(path).json(), shown, client.delete(path).json()):
        assert (status["title"], status["tags"]) == (job["title"], job["tags"])
    assert "Tip relief 20 µm" in client.get(f"{path}/events").text


def test_jobs_that_share_work_have_labels_of_their_own(client):
    for title in ("mine", "yours", ""):
        entered(client, title=title)
    assert listed(client) == ["", "yours", "mine"]


def test_the_list_is_searched_by_whole_tags_and_by_words(client):
    entered(client, title="Größe 3, 100 % torque", tags=["ev-3", "draft"])
    entered(client, title="Noise of stage_2", tags=["ev-33", "draft"])
    entered(client, title="noise and torque")
    both = ["Noise of stage_2", "Größe 3, 100 % torque"]
    assert listed(client, tag="draft") == both
    assert listed(client, tag=["draft", "EV-3"]) == both[1:]
    assert listed(client, tag="ev") == listed(client, tag=["ev-3", "ev-33"]) == []
    assert listed(client, title="NOISE") == ["noise and torque", "Noise of stage_2"]
    assert listed(client, title="torque NOI") == ["noise and torque"]
    assert listed(client, title="GRÖSSE") == both[1:]
    assert listed(client, title="0 %") == both[1:]  # neither is a pattern
    assert listed(client, title="stage_2", tag="ev-33") == both[:1]
    assert listed(client, title="e%t") == listed(client, title="noise_of") == []


def test_a_label_is_changed_in_parts(client):
    path = f"/v1/jobs/{entered(client, title='first', tags=['a']).json()['jobID']}"
    client.delete(path)
    for change, title, tags in (
        ({"title": "Second"}, "Second", ["a"]),
        ({"tags": ["b", "c"]}, "Second", ["b", "c"]),
        ({"title": None, "tags": []}, "Second", []),
        ({"title": ""}, "", []),
    ):
        assert client.patch(path, json=change).status_code == 200
        job = client.get(path).json()
        assert (job["title"], job["tags"], job["status"]) == (title, tags, "dismissed")
    assert client.patch("/v1/jobs/none", json={}).status_code == 404


@pytest.mark.parametrize(
    ("terms", "field"),
    [
        ({"title": "x" * 201}, "title"),
        ({"title": "two\nlines"}, "title"),
        ({"title": "nul\x00"}, "title"),
        ({"tags": ["a b"]}, "tags[0]"),
        ({"tags": ["x" * 41]}, "tags[0]"),
        ({"tags": [f"t{n}" for n in range(17)]}, "tags"),
    ],
)
def test_a_label_beyond_its_bounds_is_refused(client, terms, field):
    kept = entered(client, title="kept").json()["jobID"]
    for answer in (entered(client, **terms), client.patch(f"/v1/jobs/{kept}", json=terms)):
        assert answer.status_code == 422
        assert [fault["field"] for fault in answer.json()["errors"]] == [field]
    assert client.get("/v1/jobs", params={"title": "nul\x00"}).status_code == 422
    assert listed(client) == ["kept"]


def test_a_repeated_request_keeps_the_first_label(client):
    headers = {"Idempotency-Key": "once"}
    for title in ("first", "second"):
        body = {"inputs": {"wish": {}}, "title": title}
        client.post(EXECUTION, json=body, headers=headers)
    assert listed(client) == ["first"]


def test_the_client_labels_what_it_submits(client, tmp_path):
    plain = LineOfActionClient("http://testserver", cache_dir=tmp_path / "c", transport=client._transport)
    state = plain.with_terms(title="Study 7", tags=["ev-3"]).submit("fake", {"wish": {}})
    assert (state.title, state.tags) == ("Study 7", ("ev-3",))
    assert plain.submit("fake", {"wish": {}}).title == ""
    assert [job.id for job in plain.jobs(tags=["ev-3"], title="study")] == [state.id]
    assert plain.job(state.id).relabel(title="Study 8").tags == ("ev-3",)
    assert plain.status(state.id).title == "Study 8"


def test_the_verb_labels_what_it_submits(client, monkeypatch):
    plain = LineOfActionClient("http://testserver", transport=client._transport)
    monkeypatch.setattr("lineofaction.cli.submit.LineOfActionClient", lambda _: plain)
    monkeypatch.setattr(
        "lineofaction.cli.submit._submitted_state", lambda client, *_: client.submit("fake", {"wish": {}})
    )
    labels = ("--title", "Study 7", "--tag", "EV-3", "--tag", "draft")
    result = CliRunner().invoke(command, ["submit", "examples/palermo_spur_20_20.toml", *labels, "--json"])
    assert result.exit_code == 0, result.output
    (job,) = client.get("/v1/jobs").json()["jobs"]
    assert (job["title"], job["tags"]) == ("Study 7", ["ev-3", "draft"])


def test_a_priority_is_shown_and_bounded_by_the_key(client, tmp_path):
    assert entered(client, priority=9).json()["priority"] == 9
    for beyond in (10, -10, 0.5):
        assert [fault["field"] for fault in entered(client, priority=beyond).json()["errors"]] == ["priority"]
    key = KeyFile(tmp_path / "keys.json").add("ann", highest_priority=0)
    client.headers["Authorization"] = f"Bearer {key}"
    assert entered(client, priority=-1).status_code == 201
    refused = entered(client, priority=1)
    assert (refused.status_code, refused.json()["errors"][0]["field"]) == (422, "priority")
    assert "the limit of key 'ann'" in refused.json()["detail"]
