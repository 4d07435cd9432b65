"""Differences of jobs from those before them: of the same caller and process, on each database."""

from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import delete

from lineofaction.client import LineOfActionClient
from service.access.key_file import KeyFile
from service.app import create_app
from service.queue.tables import jobs
from service.schemas.examples import CASE
from service.settings import Settings
from service.store.database import writing

Json = dict[str, Any]


@pytest.fixture
def client(tmp_path, database_url):
    """A client of an app whose scheduler does not run, on each database."""
    app = create_app(Settings(data_directory=tmp_path, database_url=database_url))
    yield TestClient(app)
    app.state.context.close()


def entered(client: TestClient, process: str = "analyze", relief: float = 0.0, **headers: str) -> Json:
    pinion = CASE["pair"]["pinion"] | {"tip_relief_um": relief, "tip_relief_length_mm": 1.5}
    body = {"inputs": {"case": CASE | {"pair": CASE["pair"] | {"pinion": pinion}}}}
    answer = client.post(f"/v1/processes/{process}/execution", json=body, headers=headers)
    assert answer.status_code == 201, answer.text
    return answer.json()


def relieved(before: float, value: float) -> list[Json]:
    return [{"field": "case.pair.pinion.tip_relief_um", "before": before, "value": value}]


@pytest.mark.law
def test_a_job_is_compared_with_the_one_before_of_its_process(client):
    first = entered(client, relief=10.0)
    entered(client, "flank", relief=30.0)
    second, third = entered(client, relief=20.0), entered(client, relief=20.0)
    assert second["differences"] == {"since": first["jobID"], "first": relieved(10.0, 20.0), "number": 1}
    assert third["differences"] == {"since": second["jobID"], "first": [], "number": 0}
    listed = client.get("/v1/jobs").json()["jobs"]
    assert [job["differences"] for job in listed[:2]] == [third["differences"], second["differences"]]
    assert {job["subject"] for job in listed} == {"20/20, module 4 mm, up to 400 N m"}


def test_the_first_job_is_compared_with_the_defaults(client):
    first = entered(client, relief=10.0)["differences"]
    assert first["since"] is None
    stated = {difference["field"]: difference["value"] for difference in first["first"]}
    assert stated["case.pair.normal_module_mm"] == 4.0
    assert stated["case.pair.pinion.tip_relief_um"] == 10.0
    assert "case.accuracy.level" not in stated
    assert all(difference["before"] is None for difference in first["first"])


def test_differences_outlast_the_job_before(client):
    first, second = entered(client), entered(client, relief=20.0)
    with writing(client.app.state.context.engine) as connection:
        connection.execute(delete(jobs).where(jobs.c.id == first["jobID"]))
    assert client.get(f"/v1/jobs/{second['jobID']}").json()["differences"] == second["differences"]


def test_callers_are_compared_with_their_own_jobs(tmp_path, client):
    keys = {name: KeyFile(tmp_path / "keys.json").add(name) for name in ("ann", "ben")}
    of = {name: {"Authorization": f"Bearer {key}"} for name, key in keys.items()}
    entered(client, relief=10.0, **of["ann"])
    assert entered(client, relief=20.0, **of["ben"])["differences"]["since"] is None
    assert entered(client, relief=20.0, **of["ann"])["differences"]["first"] == relieved(10.0, 20.0)


def test_the_client_has_them(client, tmp_path):
    entered(client, relief=10.0)
    entered(client, relief=20.0)
    found = LineOfActionClient("http://testserver", cache_dir=tmp_path / "c", transport=client._transport)
    newest = next(found.jobs())
    assert (newest.subject, list(newest.differences)) == (
        "20/20, module 4 mm, up to 400 N m",
        relieved(10, 20),
    )
