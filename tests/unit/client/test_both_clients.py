"""What the blocking and the awaited client share: names, answers, order, bounds, retries."""

import inspect
import json
import time
from itertools import pairwise
from types import MappingProxyType
from typing import Any

import httpx2
import pytest
from awaited import outcome
from stored_jobs import StoredJobs, against, awaited_against, case, state

from lineofaction.client import (
    AsyncBatch,
    AsyncJob,
    AsyncLineOfActionClient,
    Batch,
    Job,
    LineOfActionClient,
    LiveOptions,
)
from lineofaction.client.event_stream import EventReader
from lineofaction.gearbox.problems import BadInput, JobFailed, NotFound, Unreachable
from lineofaction.gearbox.schemas.live import LiveInput


def public(surface: type) -> dict[str, str]:
    names = [name for name in dir(surface) if not name.startswith("_")]
    calls = {name: getattr(surface, name) for name in names}
    return {
        name: str(inspect.signature(call)) if callable(call) else type(call).__name__
        for name, call in calls.items()
        if name not in ("driver", "session", "close", "job", "batch", "process")  # of the driver
    }


@pytest.mark.parametrize(
    ("blocking", "awaited"),
    [(LineOfActionClient, AsyncLineOfActionClient), (Job, AsyncJob), (Batch, AsyncBatch)],
)
def test_both_have_one_surface(blocking, awaited):
    assert public(blocking) == public(awaited)
    assert {"submit", "events"} <= set(public(LineOfActionClient)) and {"result"} <= set(public(Job))


def test_a_live_question_has_the_options_of_its_schema_and_no_others(tmp_path):
    assert set(LiveOptions.__annotations__) == set(LiveInput.model_fields) - {"torque_n_m"}
    asked: list[Any] = []

    def answer(request):
        asked.append(json.loads(request.content))
        return httpx2.Response(404, json=NotFound("no table").as_json())

    relief = MappingProxyType({"tip_relief_um": 10.0})
    with against(answer, tmp_path) as client, pytest.raises(NotFound):
        client.ste("ab" * 32, (100.0,), pinion=relief, derivatives=True)
    (question,) = asked
    sent = LiveInput.model_validate(question)
    assert sent.torque_n_m == (100.0,) and sent.derivatives and not sent.flanks
    assert question["pinion"] == dict(relief)


def test_both_answer_alike(tmp_path):
    def blocking():
        with against(StoredJobs(), tmp_path / "a") as client:
            job = client.analyze.submit(case(20))
            return [job.file().read_text(), job.state.status, job.wait(), client.status(job.id)]

    async def awaited():
        async with awaited_against(StoredJobs(), tmp_path / "b") as client:
            job = await client.analyze.submit(case(20))
            file = await job.file()
            return [file.read_text(), job.state.status, await job.wait(), await client.status(job.id)]

    assert blocking() == outcome(awaited())


@pytest.mark.parametrize("concurrency", [1, 3, 8])
def test_a_map_keeps_the_order_and_the_bound(tmp_path, concurrency):
    """Each job is looked at another number of times; none is entered before there is room for it."""
    teeth = range(12, 40)

    def blocking(network):
        with against(network, tmp_path / "a") as client:
            jobs = client.analyze.map(map(case, teeth), concurrency=concurrency)
            return [job.file().read_text() for job in jobs]

    async def awaited(network):
        async with awaited_against(network, tmp_path / "b") as client:
            jobs = client.analyze.map(map(case, teeth), concurrency=concurrency)
            return [(await job.file()).read_text() async for job in jobs]

    one, other = StoredJobs(), StoredJobs()
    expected = [f"analyze-{number}" for number in teeth]
    assert blocking(one) == expected
    assert outcome(awaited(other)) == expected
    assert (one.most_running, other.most_running) == (concurrency, concurrency)


def test_a_map_takes_its_subjects_as_it_needs_them(tmp_path):
    taken: list[int] = []

    def cases():
        for teeth in range(12, 10_000):
            taken.append(teeth)
            yield case(teeth)

    with against(StoredJobs(), tmp_path) as client:
        jobs = client.analyze.map(cases(), concurrency=4)
        for _ in range(5):
            next(jobs)
    assert len(taken) <= 5 + 4


def test_a_job_that_fails_does_not_end_the_map(tmp_path):
    stored = StoredJobs()

    def answer(request):
        if "analyze-13" in request.url.path:
            if request.url.path.endswith("/results"):
                return httpx2.Response(500, json=JobFailed("no mesh").as_json())
            return httpx2.Response(200, json=state("analyze-13", "failed"))
        return stored(request)

    with against(answer, tmp_path) as client:
        first, second, third = client.analyze.map(map(case, (12, 13, 14)))
        assert (first.file().read_text(), third.file().read_text()) == ("analyze-12", "analyze-14")
        with pytest.raises(JobFailed, match="no mesh"):
            second.result()
        with pytest.raises(BadInput, match="teeth"):
            list(client.analyze.map([case(20), case(-1)]))


def test_a_map_asks_nothing_of_what_this_version_gave_before(tmp_path):
    network = StoredJobs()

    def mapped():
        with against(network, tmp_path) as client:
            jobs = list(client.analyze.map(map(case, (12, 13))))
            assert (
                {job.state.status for job in jobs} == {job.status().status for job in jobs} == {"successful"}
            )
            assert [event.progress for job in jobs for event in job.events()][-1] >= 10
            return [job.file().read_text() for job in jobs]

    first = mapped()
    assert len(network.keys) == 2
    assert mapped() == first and len(network.keys) == 2
    for damaged in tmp_path.rglob("*.nc"):
        damaged.write_text("something else")
    assert mapped() == first and len(network.keys) == 4
    network.version = "2"  # may give something else
    assert mapped() == first and len(network.keys) == 6


def test_a_submission_that_is_sent_again_is_the_same_request(tmp_path):
    stored, sent = StoredJobs(), [0]

    def answer(request):
        reply = stored(request)
        if request.method == "POST":
            sent[0] += 1
            if sent[0] % 2:  # it arrived, its answer did not
                raise httpx2.ReadError("the line broke")
        return reply

    with against(answer, tmp_path) as client:
        client.analyze.submit(case(20))
        client.analyze.submit(case(20))
    first, again, second, again_too = stored.keys
    assert first == again and second == again_too
    assert first != second  # another call is another request


def event(progress: int, status: str = "running") -> bytes:
    document = httpx2.Response(200, json=state("j", status) | {"progress": progress}).content
    return b"event: status\ndata: " + document + b"\n\n"


@pytest.mark.parametrize("size", [1, 2, 3, 7, 50, 10_000])
def test_events_are_read_from_pieces_of_any_size(size):
    text = event(1) + b": the job goes on\r\n\r\n" + event(2).replace(b"\n", b"\r\n") + event(100)[:-2]
    reader = EventReader()
    documents = [d for at in range(0, len(text), size) for d in reader.documents(text[at : at + size])]
    assert [document["progress"] for document in documents] == [1, 2]  # the last one is not complete


def test_a_stream_that_breaks_is_taken_up_again(tmp_path, monkeypatch):
    monkeypatch.setattr(time, "sleep", lambda _seconds: None)
    opened: list[str] = []

    def pieces():
        yield event(1)
        if len(opened) == 1:
            yield event(2)[:30]
            raise httpx2.ReadError("the line broke")
        yield event(3) + event(100, "successful")

    def answer(request):
        opened.append(request.url.path)
        return httpx2.Response(200, content=pieces(), headers={"Content-Type": "text/event-stream"})

    with against(answer, tmp_path) as client:
        seen = [found.progress for found in client.events("j")]
    assert seen == [1, 3, 100]  # what did not change is not told twice
    assert opened == ["/v1/jobs/j/events"] * 2


def test_events_of_what_is_no_stream_are_refused(tmp_path):
    for reply in (
        httpx2.Response(200, text="<html>"),
        httpx2.Response(200, headers={"Content-Type": "text/event-stream"}),
    ):
        network: Any = lambda _request, reply=reply: reply  # noqa: E731
        with (
            against(network, tmp_path) as client,
            pytest.raises(Unreachable, match="not an answer of this service"),
        ):
            list(client.events("j"))


@pytest.mark.parametrize(("limit", "requests"), [(None, 3), (1, 1), (100, 1), (101, 2), (250, 3), (900, 3)])
def test_lists_come_page_by_page_as_far_as_they_are_wanted(tmp_path, limit, requests):
    asked: list[httpx2.URL] = []

    def answer(request):
        asked.append(request.url)
        begin, size = int(request.url.params.get("cursor", 0)), int(request.url.params["limit"])
        numbers = range(begin, min(begin + size, 250))
        link = {"rel": "next", "href": f"/v1/jobs?limit={size}&cursor={begin + size}"}
        links = [link] if begin + size < 250 else []
        return httpx2.Response(
            200, json={"jobs": [state(str(n), "running") for n in numbers], "links": links}
        )

    with against(answer, tmp_path) as client:
        found = [
            job.id for job in client.jobs(process=["analyze"], status=["running", "failed"], limit=limit)
        ]
    assert found == [str(n) for n in range(250)][:limit]
    assert len(asked) == requests
    assert asked[0].params.get_list("status") == ["running", "failed"]
    assert all(a != b for a, b in pairwise(asked))
