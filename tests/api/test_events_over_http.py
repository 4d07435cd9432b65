"""Server-sent events: the status now and at every change, the final one last, a bounded number of streams."""

import asyncio
import json
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import pairwise
from typing import Any

from fastapi.testclient import TestClient
from running_service import until
from service_fakes import EXECUTION

from service.routes import events


def execute(client: TestClient, **wish: Any) -> str:
    answer = client.post(EXECUTION, json={"inputs": {"wish": wish}})
    return str(answer.headers["location"])


def documents(text: str) -> list[dict[str, Any]]:
    blocks = [block for block in text.split("\n\n") if block and not block.startswith(":")]
    assert all(block.startswith("event: status\nid: ") for block in blocks)
    return [json.loads(block.partition("data: ")[2]) for block in blocks]


def test_the_stream_tells_every_change_once_and_ends_with_the_job(client):
    location = execute(client, text="table")
    answer = client.get(f"{location}/events")
    told = documents(answer.text)
    assert answer.headers["content-type"].startswith("text/event-stream")
    assert answer.headers["cache-control"] == "no-store"
    assert told[-1] == client.get(location).json()
    assert told[-1]["status"] == "successful"
    assert [status for status in told if status["status"] == "successful"] == told[-1:]
    assert all(one != other for one, other in pairwise(told))


def test_who_comes_after_the_end_gets_the_final_state(client):
    location = execute(client, text="table")
    first = documents(client.get(f"{location}/events").text)
    assert documents(client.get(f"{location}/events").text) == first[-1:]


def test_who_names_the_last_event_is_not_sent_it_again(client, monkeypatch):
    monkeypatch.setattr(events, "HEARTBEAT_S", 0.05)
    location = execute(client, mode="hang")
    until(lambda: client.get(location).json()["stage_progress"] > 0)  # nothing more happens by itself
    now = client.get(location).json()["updated"]
    cancel = partial(client.delete, location)
    sent = _apart(_listen_and_leave(client.app, f"{location}/events", b"status", last=now, after=cancel))
    assert [status["status"] for status in documents(sent.decode())] == ["dismissed"]


def test_a_browser_that_has_the_final_event_is_told_to_connect_no_more(client):
    location = execute(client, text="table")
    text = client.get(f"{location}/events").text
    last = text.rpartition("id: ")[2].partition("\n")[0]
    answer = client.get(f"{location}/events", headers={"Last-Event-ID": last})
    assert (answer.status_code, answer.content) == (204, b"")
    assert client.get(f"{location}/events", headers={"Last-Event-ID": "another"}).status_code == 200


def test_a_service_that_stops_ends_its_streams(client):
    location = execute(client, mode="hang")
    until(lambda: client.get(location).json()["stage_progress"] > 0)
    stop = client.app.state.context.stop_waiting
    sent = _apart(_listen_and_leave(client.app, f"{location}/events", b"never", after=stop))
    assert documents(sent.decode())[-1]["status"] in ("accepted", "running")
    client.delete(location)


def test_an_unknown_job_has_no_stream(client):
    answer = client.get("/v1/jobs/nothing/events")
    assert (answer.status_code, answer.headers["content-type"]) == (404, "application/problem+json")


def test_streams_are_bounded_and_given_back(client):
    streams = client.app.state.context.streams
    location = execute(client, text="table")
    streams.maximum = 1
    assert client.get(f"{location}/events").status_code == 200
    streams.enter()
    answer = client.get(f"{location}/events")
    assert (answer.status_code, answer.headers["retry-after"]) == (429, "10")
    assert answer.json()["type"] == "urn:lineofaction:problem:too-many-streams"
    streams.leave()
    assert client.get(f"{location}/events").status_code == 200


def test_a_caller_who_leaves_frees_the_stream_while_the_job_goes_on(client):
    location = execute(client, mode="hang")
    streams = client.app.state.context.streams
    sent = _apart(_listen_and_leave(client.app, f"{location}/events"))
    assert documents(sent.decode())[0]["status"] in ("accepted", "running")
    assert streams._open == 0
    assert client.get(location).json()["status"] in ("accepted", "running")
    client.delete(location)


def test_comments_keep_a_quiet_stream_open(client, monkeypatch):
    monkeypatch.setattr(events, "HEARTBEAT_S", 0.0)
    location = execute(client, mode="hang")
    sent = _apart(_listen_and_leave(client.app, f"{location}/events", wanted=b": the job goes on\n\n"))
    assert sent.endswith(b": the job goes on\n\n")
    client.delete(location)


def _apart(coroutine: Coroutine[Any, Any, Any]) -> Any:
    """Run it in a thread of its own: a browser of another test may hold a loop in this one."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, coroutine).result()


async def _listen_and_leave(
    app: Any,
    path: str,
    wanted: bytes = b"\n\n",
    *,
    last: str = "",
    after: Callable[[], object] = lambda: None,
) -> bytes:
    """Return what the app sends until `wanted` is among it, then disconnect.

    `after` is called with the first event or comment; `last` is the event that the caller had last.
    """
    heard, enough = [], asyncio.Event()
    scope = {
        "type": "http",
        "method": "GET",
        "path": path,
        "query_string": b"",
        "headers": [(b"last-event-id", last.encode())] if last else [],
    }
    asked = iter([{"type": "http.request", "body": b"", "more_body": False}])

    async def receive():
        for message in asked:
            return message
        await enough.wait()
        return {"type": "http.disconnect"}

    async def send(message):
        heard.append(message.get("body", b""))
        if len(heard) == 2:
            asyncio.get_running_loop().run_in_executor(None, after)
        if wanted in heard[-1]:
            enough.set()

    scope |= {"http_version": "1.1", "scheme": "http", "server": ("testserver", 80), "root_path": ""}
    scope |= {"raw_path": path.encode(), "client": ("127.0.0.1", 1)}
    await asyncio.wait_for(app(scope, receive, send), timeout=60.0)
    return b"".join(heard)
