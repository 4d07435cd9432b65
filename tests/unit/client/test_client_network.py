"""The client on a network that fails: what is asked again, what is told, and how a job is waited for."""

import base64
import hashlib
import re
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime
from itertools import pairwise

import httpx2
import pytest
from stored_jobs import against, state

from lineofaction.client import LineOfActionClient
from lineofaction.client.problem_answers import problem_of
from lineofaction.gearbox import problems
from lineofaction.gearbox.problems import (
    BadInput,
    JobFailed,
    QueueFull,
    ServiceError,
    StillRunning,
    Unexpected,
    Unreachable,
)
from service.version import solver_version

KEY = "ab" * 32


def seen(status: str) -> httpx2.Response:
    return httpx2.Response(200, json=state("j", status))


def results() -> httpx2.Response:
    reference = {"href": f"/v1/results/{KEY}", "type": "", "hash": KEY}
    return httpx2.Response(200, json={"database": reference})


@pytest.mark.parametrize("method", ["status", "submit", "dismiss"])
@pytest.mark.parametrize(
    ("status", "again"),
    [(429, True), (502, True), (503, True), (504, True)]
    + [(status, False) for status in (301, 400, 401, 404, 409, 410, 413, 422, 500)],
)
def test_what_may_pass_is_asked_again_whatever_the_method(tmp_path, slept, method, status, again):
    asked: list[str] = []

    def answer(request):
        asked.append(request.method)
        return httpx2.Response(status, text="no")

    client = against(answer, tmp_path, attempts=3)
    with pytest.raises(ServiceError):
        client.submit("analyze", {}) if method == "submit" else getattr(client, method)("j")
    assert len(asked) == (3 if again else 1)
    assert len(set(asked)) == 1


def test_the_service_says_when_in_seconds_or_as_a_date(tmp_path, slept):
    later = format_datetime(datetime.now(UTC) + timedelta(seconds=6), usegmt=True)
    past = format_datetime(datetime.now(UTC) - timedelta(days=1), usegmt=True)
    asked = iter(["3", later, past, "3600", "soon", None])

    def answer(_request):
        when = next(asked)
        return seen("running") if when is None else httpx2.Response(503, headers={"Retry-After": when})

    assert against(answer, tmp_path, attempts=6).status("j").status == "running"
    first, second, third, fourth, fifth = slept
    assert (first, third, fourth) == (3.0, 0.0, 10.0)  # no longer than 10 s
    assert 4.5 < second <= 6.0
    assert 0.0 < fifth <= 2.0  # no time said: its own


@pytest.mark.parametrize(
    ("response", "said"),
    [
        (
            httpx2.Response(301, headers={"Location": "https://gears.example/"}),
            r"sends to https://gears\.example/",
        ),
        (
            httpx2.Response(200, text="<html>log in</html>"),
            "status 200, which is not an answer of this service",
        ),
        (httpx2.Response(200, json=["a", "list"]), "status 200, which is not an answer of this service"),
        (httpx2.Response(200, json={"status": "ok"}), "status 200, which is not an answer of this service"),
        (httpx2.Response(500, json={"detail": None}), "status 500, which is not an answer of this service"),
    ],
)
def test_what_is_not_this_service_is_told_as_such(tmp_path, response, said):
    client = against(lambda _request: response, tmp_path)
    with pytest.raises(Unreachable, match=said):
        client.status("j")
    with pytest.raises(Unreachable, match=said):
        client.result("j")


def test_forces_that_are_no_columns_are_not_taken_for_some(tmp_path):
    client = against(lambda _request: httpx2.Response(200, text="x" * 24), tmp_path)
    with pytest.raises(Unreachable, match="which is not an answer of this service"):
        client.query(KEY, 0.0, 1.0)


@pytest.mark.parametrize(
    "address", ["nowhere", "127.0.0.1:8321", "localhost:8321", "ftp://here", "http://", "http://[::1"]
)
def test_an_address_that_is_none_is_refused_at_once(tmp_path, address):
    with pytest.raises(
        BadInput, match=f"service = '{re.escape(address)}': must be an address such as .*http://"
    ):
        LineOfActionClient(address, cache_dir=tmp_path)


def test_address_and_key_come_from_the_environment(tmp_path, monkeypatch):
    monkeypatch.setenv("LOA_SERVICE", "http://gears.example:99/behind/")
    monkeypatch.setenv("LOA_KEY", "secret")
    sent: list[httpx2.Request] = []

    def answer(request):
        sent.append(request)
        return seen("running")

    LineOfActionClient(cache_dir=tmp_path, transport=httpx2.MockTransport(answer)).status("j")
    assert str(sent[0].url) == "http://gears.example:99/behind/v1/jobs/j"
    assert sent[0].headers["authorization"] == "Bearer secret"
    assert sent[0].headers["user-agent"] == f"lineofaction/{solver_version()}"


MADE_OF_TEXT = [
    kind
    for kind in vars(problems).values()
    if isinstance(kind, type) and issubclass(kind, ServiceError) and "type" in vars(kind)
    if kind not in (ServiceError, BadInput, JobFailed, Unexpected)
]


@pytest.mark.parametrize("kind", MADE_OF_TEXT, ids=lambda kind: kind.__name__)
def test_every_problem_comes_back_as_the_error_it_was(kind):
    request = httpx2.Request("GET", "http://127.0.0.1/v1/jobs")
    found = problem_of(httpx2.Response(kind.status, json=kind("why").as_json(), request=request))
    assert (type(found), str(found)) == (kind, "why")


def test_there_are_as_many_errors_as_the_tree_shows():
    assert {"NotFound", "NoSuchJob", "QueueFull", "StoreUnavailable"} <= {k.__name__ for k in MADE_OF_TEXT}


def test_a_download_that_breaks_is_begun_again(tmp_path, slept):
    content, asked = b"0123456789" * 100_000, [0]

    def pieces():
        asked[0] += 1
        if asked[0] < 3:
            yield b"9876543210" * 110_000
            raise httpx2.ReadError("the line broke")
        yield content

    digest = base64.b64encode(hashlib.sha256(content).digest()).decode()

    def answer(_request):
        return httpx2.Response(200, content=pieces(), headers={"Content-Digest": f"sha-256=:{digest}:"})

    assert against(answer, tmp_path).fetch_file(KEY).read_bytes() == content
    assert asked == [3]


def test_waiting_looks_often_at_first_and_never_more_than_a_tenth_of_the_time_late(tmp_path, slept):
    looks: list[float] = []

    def answer(request):
        if request.url.path.endswith("/results"):
            return results()
        looks.append(sum(slept))
        return seen("running" if sum(slept) < 600.0 else "successful")

    against(answer, tmp_path).wait("j", interval=0.05)
    pauses = [after - before for before, after in pairwise(looks)]
    assert pauses[0] == pytest.approx(0.05)
    assert all(pause <= 0.05 + 0.1 * at + 1e-9 for pause, at in zip(pauses, looks, strict=False))
    assert max(pauses) == pytest.approx(2.0)
    assert len(looks) < 360  # 3000 at 0.2 s


def test_a_restart_of_the_service_is_waited_out(tmp_path, slept):
    away = [True]

    def answer(request):
        if 1.0 < sum(slept) < 21.0:
            away.append(True)
            raise httpx2.ConnectError("refused")
        return (
            results()
            if request.url.path.endswith("/results")
            else seen("successful" if sum(slept) > 21.0 else "running")
        )

    assert against(answer, tmp_path).wait("j").key == KEY
    assert len(away) > 4


def test_patience_has_an_end(tmp_path, slept):
    def answer(_request):
        if sum(slept) > 1.0:
            raise httpx2.ConnectError("refused")
        return seen("running")

    with pytest.raises(Unreachable, match="loa serve"):
        against(answer, tmp_path, patience=30.0).wait("j")
    assert 30.0 < sum(slept) < 40.0


def test_a_service_that_never_answered_is_told_at_once(tmp_path, slept):
    def answer(_request):
        raise httpx2.ConnectError("refused")

    with pytest.raises(Unreachable):
        against(answer, tmp_path).wait("j")
    assert sum(slept) < 2.0


def test_the_time_to_wait_is_kept_and_is_a_timeout(tmp_path, slept):
    with pytest.raises(StillRunning, match=r"Job j did not end within 5 s\. It continues") as caught:
        against(lambda _request: seen("running"), tmp_path).wait("j", timeout=5.0)
    assert isinstance(caught.value, TimeoutError)
    assert sum(slept) == pytest.approx(5.0)


def test_ctrl_c_leaves_the_job_and_says_so(tmp_path):
    methods: list[str] = []

    def answer(request):
        methods.append(request.method)
        return seen("running")

    def interrupted(_state):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        against(answer, tmp_path).wait("j", interrupted)
    assert caught.value.__notes__ == ["Job j continues at the service. Repeat the request to join it."]
    assert methods == ["GET"]


@pytest.mark.parametrize(("version", "noted"), [("99.0", True), (solver_version(), False), (None, False)])
def test_a_refusal_by_another_version_says_so(tmp_path, version, noted):
    refusal = BadInput.of("case.pair.news", 1, "left out").as_json()

    def answer(request):
        if request.url.path == "/v1/":
            return httpx2.Response(200, json={} if version is None else {"version": version})
        return httpx2.Response(422, json=refusal)

    with pytest.raises(BadInput, match=r"case\.pair\.news") as caught:
        against(answer, tmp_path).submit("analyze", {})
    notes = getattr(caught.value, "__notes__", [])
    assert [("99.0" in note and solver_version() in note) for note in notes] == ([True] if noted else [])


def test_a_full_queue_is_asked_again_before_it_is_told(tmp_path, slept):
    body = QueueFull("100 computations wait already.").as_json()

    def full(_request):
        return httpx2.Response(429, json=body, headers={"Retry-After": "7"})

    with pytest.raises(QueueFull, match="100 computations"):
        against(full, tmp_path, attempts=3).submit("fake", {})
    assert slept == [7.0, 7.0]
