"""Services that go away in the middle, and callers that do: no job is lost, none is left unsaid."""

import asyncio
import json
import time
from contextlib import aclosing
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread

import httpx2
import pytest
from awaited import outcome
from stored_jobs import StoredJobs, against, awaited_against, case, state

from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.problems import BadInput, QueueFull, Unreachable


class Restarting(StoredJobs):
    """Every `period` requests the service is away for some seconds of a clock that the client's pauses move.

    What is sent while it goes away is done, and its answer lost.
    """

    def __init__(self, clock: list[float], period: int, seconds: float) -> None:
        super().__init__()
        self.clock, self.period, self.seconds = clock, period, seconds
        self.requests, self.until, self.outages = 0, 0.0, 0

    def __call__(self, request: httpx2.Request) -> httpx2.Response:
        if sum(self.clock) < self.until:
            raise httpx2.ConnectError("refused")
        answer = super().__call__(request)
        self.requests += 1
        if self.requests % self.period == 0:
            self.until, self.outages = sum(self.clock) + self.seconds, self.outages + 1
            raise httpx2.ReadError("the line broke")
        return answer


@pytest.mark.parametrize("period", [4, 5, 7, 11])
def test_a_map_outlasts_restarts_wherever_they_fall(tmp_path, slept, period):
    network = Restarting(slept, period, seconds=10.0)
    with against(network, tmp_path) as client:
        jobs = client.analyze.map(map(case, range(12, 20)), concurrency=3)
        assert [job.file().read_text() for job in jobs] == [f"analyze-{teeth}" for teeth in range(12, 20)]
    assert network.outages >= 4
    assert len(set(network.keys)) == 8  # what is sent again is the same submission


def test_a_map_ends_when_the_service_stays_away(tmp_path, slept):
    with (
        against(Restarting(slept, 6, seconds=1e6), tmp_path, patience=30.0) as client,
        pytest.raises(Unreachable) as caught,
    ):
        list(client.analyze.map(map(case, range(12, 20)), concurrency=3))
    assert 30.0 < sum(slept) < 100.0
    assert any("continues at the service" in note for note in caught.value.__notes__)


def test_a_full_queue_delays_a_map(tmp_path, slept):
    network, full = StoredJobs(), QueueFull("100 computations wait already.").as_json()

    def answer(request):
        if request.method == "POST" and sum(slept) < 40.0:
            return httpx2.Response(429, json=full, headers={"Retry-After": "7"})
        return network(request)

    with against(answer, tmp_path) as client:
        assert len(list(client.analyze.map(map(case, (12, 13))))) == 2


def test_a_restart_while_the_result_is_fetched_is_waited_out(tmp_path, slept):
    network = StoredJobs()
    with against(network, tmp_path) as client:
        job = client.analyze.submit(case(20))
        result = job.wait()
        begin = sum(slept)

        def answer(request):
            if sum(slept) - begin < 20.0:
                raise httpx2.ConnectError("refused")
            return network(request)

        client.driver._http._transport = httpx2.MockTransport(answer)
        assert job.file().read_text() == "analyze-20"
    assert result.kind == "database"


class Endless(StoredJobs):
    """Jobs of more than 13 teeth never end."""

    def __init__(self) -> None:
        super().__init__()
        self.dismissed: set[str] = set()

    def __call__(self, request: httpx2.Request) -> httpx2.Response:
        job = request.url.path.split("/")[3] if request.url.path.startswith("/v1/jobs/") else ""
        if request.method == "DELETE":
            self.dismissed.add(job)
            return httpx2.Response(200, json=state(job, "dismissed"))
        if job and int(job.rpartition("-")[2]) > 13:
            return httpx2.Response(200, json=state(job, "running"))
        return super().__call__(request)


UNDER_WAY = {"analyze-14", "analyze-15", "analyze-16"}


def test_a_loop_left_early_dismisses_what_is_under_way(tmp_path):
    network = Endless()
    with against(network, tmp_path) as client:
        for job in client.analyze.map(map(case, range(13, 40)), concurrency=4):
            assert job.id == "analyze-13"
            break
        assert network.dismissed == network.running == UNDER_WAY


def test_an_awaited_loop_left_early_dismisses_what_is_under_way(tmp_path):
    network = Endless()

    async def left():
        async with awaited_against(network, tmp_path) as client:
            async with aclosing(client.analyze.map(map(case, range(13, 40)), concurrency=4)) as jobs:
                async for job in jobs:
                    assert job.id == "analyze-13"
                    break
            assert network.dismissed == network.running == UNDER_WAY

    outcome(left())


def noted(error: BaseException) -> set[str]:
    """Return the jobs that an error says to continue, each said once."""
    notes = [note for note in getattr(error, "__notes__", ()) if "continues at the service" in note]
    assert len(set(notes)) == len(notes)
    return {note.split()[1] for note in notes}


@pytest.mark.parametrize("looks", [3, 4, 9])
def test_ctrl_c_in_a_map_says_which_jobs_continue(tmp_path, monkeypatch, looks):
    network, pauses = Endless(), [0]

    def stop(_seconds):
        pauses[0] += 1
        if pauses[0] > looks:
            raise KeyboardInterrupt

    with against(network, tmp_path) as client:
        jobs = client.analyze.map(map(case, range(14, 40)), concurrency=3)
        monkeypatch.setattr(time, "sleep", stop)
        with pytest.raises(KeyboardInterrupt) as caught:
            next(jobs)
    assert noted(caught.value) == network.running and network.running and not network.dismissed


def test_what_is_cancelled_says_which_jobs_continue(tmp_path):
    network = Endless()

    async def cancelled():
        async with awaited_against(network, tmp_path) as client:

            async def mapped():
                async for _ in client.analyze.map(map(case, range(14, 40)), concurrency=3):
                    pass

            async def waited():
                await client.wait("analyze-99")

            errors = []
            for work in (mapped, waited):
                task = asyncio.create_task(work())
                await asyncio.sleep(0.3)
                task.cancel()
                with pytest.raises(asyncio.CancelledError) as caught:
                    await task
                errors.append(caught.value)
            return errors[0], errors[1]

    of_map, of_wait = outcome(cancelled())
    assert noted(of_map) == UNDER_WAY and noted(of_wait) == {"analyze-99"} and not network.dismissed


def test_a_map_of_no_jobs_at_once_is_refused(tmp_path):
    with against(StoredJobs(), tmp_path) as client, pytest.raises(BadInput, match="concurrency = 0"):
        list(client.analyze.map([case(20)], concurrency=0))


@pytest.mark.parametrize("ahead", [timedelta(hours=-3), timedelta(0), timedelta(hours=3)])
def test_a_clock_that_is_wrong_does_not_change_the_pause(tmp_path, slept, ahead):
    """The service says when by its own clock, which its answer shows."""
    theirs = datetime.now(UTC) + ahead
    when = {"Date": theirs, "Retry-After": theirs + timedelta(seconds=6)}
    headers = {name: format_datetime(date, usegmt=True) for name, date in when.items()}
    answers = iter([httpx2.Response(503, headers=headers), httpx2.Response(200, json=state("j", "running"))])
    against(lambda _request: next(answers), tmp_path).status("j")
    assert slept == [6.0]


def test_events_that_are_interrupted_say_so_and_those_that_end_do_at_once(tmp_path, slept):
    def stream(status, error):
        def pieces():
            yield b"data: " + json.dumps(state("j", status)).encode() + b"\n\n"
            if error is not None:
                raise error

        return httpx2.Response(200, content=pieces(), headers={"Content-Type": "text/event-stream"})

    with pytest.raises(KeyboardInterrupt) as caught:
        list(against(lambda _request: stream("running", KeyboardInterrupt), tmp_path).events("j"))
    assert noted(caught.value) == {"j"}
    (last,) = against(lambda _request: stream("successful", None), tmp_path).events("j")
    assert last.ended and slept == []


def test_a_body_that_ends_too_early_is_asked_for_again(tmp_path):
    """By a real server: the first answer promises more bytes than come."""
    body = json.dumps(state("j", "running")).encode()
    asked: list[str] = []

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            asked.append(self.path)
            self.send_response(200)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body if len(asked) > 1 else body[:20])

        def log_message(self, *_args):
            """Say nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    Thread(target=server.serve_forever, daemon=True).start()
    try:
        with LineOfActionClient(f"http://127.0.0.1:{server.server_port}", cache_dir=tmp_path) as client:
            assert client.status("j").status == "running"
    finally:
        server.shutdown()
        server.server_close()
    assert asked == ["/v1/jobs/j"] * 2
