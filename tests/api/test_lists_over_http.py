"""Lists page by page: every entry once, whatever is deleted meanwhile; filters; cases of databases."""

import hashlib
import threading
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from fastapi.testclient import TestClient
from running_service import until
from service_fakes import EXECUTION, REGISTRY
from small_table import small_table
from sqlalchemy import delete, update

from service.app import create_app
from service.queue.tables import computations, jobs
from service.settings import Settings
from service.store.database import writing


@pytest.fixture
def client(tmp_path):
    """A client of an app whose scheduler does not run: jobs stay as they are put."""
    return TestClient(create_app(Settings(data_directory=tmp_path), REGISTRY))


def submit(client: TestClient, count: int) -> list[str]:
    """Enter jobs; return their identifiers, the newest first."""
    answers = [client.post(EXECUTION, json={"inputs": {"wish": {"number": n / 10}}}) for n in range(count)]
    return [answer.json()["jobID"] for answer in answers][::-1]


def change(client: TestClient, statement: Any) -> None:
    """Change the tables behind the service's back."""
    with writing(client.app.state.context.submissions._engine) as connection:
        connection.execute(statement)


def following(page: dict[str, Any]) -> str | None:
    return next((link["href"] for link in page["links"] if link["rel"] == "next"), None)


def identifiers(page: dict[str, Any]) -> list[str]:
    return [job["jobID"] for job in page["jobs"]]


def test_pages_go_on_behind_a_job_that_was_deleted(client):
    newest_first = submit(client, 5)
    page = client.get("/v1/jobs", params={"limit": 2}).json()
    assert identifiers(page) == newest_first[:2]
    change(client, delete(jobs).where(jobs.c.id == newest_first[1]))
    change(client, delete(jobs).where(jobs.c.id == newest_first[2]))
    rest = client.get(following(page)).json()
    assert identifiers(rest) == newest_first[3:]
    assert following(rest) is None


def test_jobs_entered_meanwhile_do_not_shift_the_pages(client):
    newest_first = submit(client, 4)
    page = client.get("/v1/jobs", params={"limit": 2}).json()
    submit(client, 3)
    assert identifiers(client.get(following(page)).json()) == newest_first[2:]


def test_a_page_that_is_just_full_is_the_last(client):
    submit(client, 2)
    assert following(client.get("/v1/jobs", params={"limit": 2}).json()) is None


def test_filters_add_up_and_stay_on_the_next_page(client):
    newest_first = submit(client, 6)
    for job in newest_first[:3]:
        client.delete(f"/v1/jobs/{job}")
    wish = {"status": ["dismissed", "failed"], "processID": "fake", "limit": 2}
    page = client.get("/v1/jobs", params=wish).json()
    assert identifiers(page) == newest_first[:2]
    assert identifiers(client.get(following(page)).json()) == newest_first[2:3]
    assert identifiers(client.get("/v1/jobs", params={"status": "accepted"}).json()) == newest_first[3:]
    assert identifiers(client.get("/v1/jobs", params={"processID": "other"}).json()) == []
    assert len(identifiers(client.get("/v1/jobs", params={"type": "process"}).json())) == 6


def test_jobs_of_a_time(client):
    newest, middle, oldest = submit(client, 3)
    noon = datetime(2026, 1, 31, 12, tzinfo=UTC)
    for job, hours in ((newest, 2), (middle, 1), (oldest, 0)):
        instant = (noon + timedelta(hours=hours)).isoformat(timespec="microseconds").replace("+00:00", "Z")
        change(client, update(jobs).where(jobs.c.id == job).values(created=instant))

    def found(text):
        return identifiers(client.get("/v1/jobs", params={"datetime": text}).json())

    assert found("2026-01-31T13:00:00Z") == [middle]
    assert found("2026-01-31T14:00:00+01:00") == [middle]
    assert found("2026-01-31T12:30:00Z/..") == [newest, middle]
    assert found("../2026-01-31T13:00:00Z") == [middle, oldest]
    assert found("2026-01-31T12:00:00Z/2026-01-31T13:59:59Z") == [middle, oldest]


def test_jobs_that_ran_so_long(client):
    long, short, waits = submit(client, 3)
    for job, seconds in ((long, 90), (short, 5)):
        key = client.app.state.context.submissions.find(job).key
        ended = f"2026-01-31T12:{seconds // 60:02d}:{seconds % 60:02d}.000000Z"
        values = {"state": "successful", "started": "2026-01-31T12:00:00.000000Z", "finished": ended}
        change(client, update(computations).where(computations.c.key == key).values(**values))
    for wish, wanted in (
        ({"minDuration": 10}, [long]),
        ({"maxDuration": 10}, [short]),
        ({"minDuration": 5, "maxDuration": 90}, [long, short]),
        ({"maxDuration": 0}, []),
        ({}, [long, short, waits]),
    ):
        assert identifiers(client.get("/v1/jobs", params=wish).json()) == wanted


@pytest.mark.parametrize(
    ("parameters", "field"),
    [
        ({"cursor": "AAAA"}, "cursor"),
        ({"cursor": "no base64!"}, "cursor"),
        ({"cursor": ""}, "cursor"),
        ({"datetime": "yesterday"}, "datetime"),
        ({"datetime": "2026-01-31T12:00:00"}, "datetime"),
        ({"datetime": "../../.."}, "datetime"),
        ({"datetime": "0001-01-01T00:00:00+23:00"}, "datetime"),
        ({"status": "gone"}, "status[0]"),
        ({"type": "other"}, "type[0]"),
        ({"minDuration": -1}, "minDuration"),
        ({"limit": 1001}, "limit"),
    ],
)
def test_a_filter_that_is_none_is_refused_by_name(client, parameters, field):
    answer = client.get("/v1/jobs", params=parameters)
    assert (answer.status_code, answer.headers["content-type"]) == (422, "application/problem+json")
    assert [fault["field"] for fault in answer.json()["errors"]] == [field]


def test_databases_are_listed_with_their_cases(client, tmp_path):
    store = client.app.state.context.store
    keys = [hashlib.sha256(bytes([n])).hexdigest() for n in range(3)]
    for key in keys:
        small_table().to_netcdf(tmp_path / "table.nc")
        store.put(key, "database", tmp_path / "table.nc")
    store.verified(keys[0], "database").path.write_bytes(b"damaged")
    page = client.get("/v1/databases", params={"limit": 2}).json()
    rest = client.get(following(page)).json()
    entries = [*page["databases"], *rest["databases"]]
    assert [entry["hash"] for entry in entries] == keys[::-1]
    assert [entry["case"] for entry in entries] == [{"name": "closed form"}] * 2 + [None]
    assert client.get(entries[0]["href"]).json()["size"] == entries[0]["size"]


def test_processes_come_in_pages_too(tmp_path):
    client, seen = TestClient(create_app(Settings(data_directory=tmp_path))), []
    href: str | None = "/v1/processes?limit=3"
    while href is not None:
        page = client.get(href).json()
        seen.append([process["id"] for process in page["processes"]])
        href = following(page)
    whole = [process["id"] for process in client.get("/v1/processes").json()["processes"]]
    assert [name for names in seen for name in names] == whole
    assert all(len(names) == 3 for names in seen[:-1])


def test_ended_jobs_are_found_by_their_status(client):
    submit(client, 1)
    with client:
        until(lambda: len(client.get("/v1/jobs", params={"status": "successful"}).json()["jobs"]) == 1)
        assert client.get("/v1/jobs", params={"status": ["accepted", "running"]}).json()["jobs"] == []


@pytest.mark.parametrize("path", ["/v1/jobs", "/v1/jobs?once=true&limit=1", "/v1/databases"])
def test_a_list_that_a_caller_has_is_not_sent_again(client, tmp_path, path):
    submit(client, 2)
    first = client.get(path)
    tag = {"If-None-Match": first.headers["etag"]}
    again = client.get(path, headers=tag)
    assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", first.headers["etag"])
    submit(client, 3)
    store = client.app.state.context.store
    small_table().to_netcdf(tmp_path / "table.nc")
    store.put("ab" * 32, "database", tmp_path / "table.nc")
    changed = client.get(path, headers=tag)
    assert changed.status_code == 200 and changed.json() != first.json()


def test_lists_take_no_thread_from_other_requests(client, monkeypatch):
    """Lists that wait for the database, more than there are threads for requests, hold up nobody else."""
    (job,) = submit(client, 1)
    submissions, go_on = client.app.state.context.submissions, threading.Event()

    def late(*_):
        go_on.wait(60.0)
        return []

    monkeypatch.setattr(type(submissions), "page", late)
    with client, ThreadPoolExecutor(50) as callers:
        lists = [callers.submit(client.get, "/v1/jobs") for _ in range(50)]
        try:
            assert client.get(f"/v1/jobs/{job}").status_code == 200
            assert not any(one.done() for one in lists)
        finally:
            go_on.set()
        assert {one.result().status_code for one in lists} == {200}
