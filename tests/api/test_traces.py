"""Traces and the log: from the caller to the stages of the worker; identifiers of callers are kept."""

import json
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from opentelemetry.proto.collector.trace.v1.trace_service_pb2 import (
    ExportTraceServiceRequest,
    ExportTraceServiceResponse,
)
from opentelemetry.sdk.trace import TracerProvider
from running_service import until
from served_app import served
from service_fakes import EXECUTION, REGISTRY

from lineofaction.cli.serve import log_to_standard_error
from lineofaction.client import LineOfActionClient
from service.app import create_app
from service.queue.worker_figures import WorkerFigures
from service.settings import Settings
from service.tracing import begun_span, current_traceparent, flush_spans, span_provider


@dataclass(frozen=True)
class ReceivedSpan:
    """A span as it came over the wire; identifiers are hexadecimal, times s since 1970."""

    name: str
    trace: str
    id: str
    parent: str
    begun: float
    ended: float
    failed: bool
    facts: dict[str, Any]


@dataclass
class TraceReceiver:
    """What has come, and where from."""

    spans: list[ReceivedSpan] = field(default_factory=list)
    services: set[str] = field(default_factory=set)
    address: str = ""

    def named(self, name: str) -> list[ReceivedSpan]:
        return [span for span in self.spans if span.name == name]

    def take(self, body: bytes) -> None:
        for group in ExportTraceServiceRequest.FromString(body).resource_spans:
            self.services.add(_facts(group.resource.attributes)["service.name"])
            for scope in group.scope_spans:
                self.spans.extend(map(_received, scope.spans))


def _received(span: Any) -> ReceivedSpan:
    identifiers = (span.trace_id.hex(), span.span_id.hex(), span.parent_span_id.hex())
    times = (span.start_time_unix_nano / 1e9, span.end_time_unix_nano / 1e9)
    return ReceivedSpan(span.name, *identifiers, *times, span.status.code == 2, _facts(span.attributes))


def _facts(attributes: Any) -> dict[str, Any]:
    return {entry.key: getattr(entry.value, entry.value.WhichOneof("value")) for entry in attributes}


@contextmanager
def trace_receiver() -> Iterator[TraceReceiver]:
    received = TraceReceiver()

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self):
            assert self.path == "/v1/traces"
            received.take(self.rfile.read(int(self.headers["Content-Length"])))
            answer = ExportTraceServiceResponse().SerializeToString()
            self.send_response(200)
            self.send_header("Content-Type", "application/x-protobuf")
            self.send_header("Content-Length", str(len(answer)))
            self.end_headers()
            self.wfile.write(answer)

        def log_message(self, *_):
            """Say nothing."""

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        received.address = f"http://127.0.0.1:{server.server_port}"
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield received
        finally:
            server.shutdown()
            thread.join()


TRACE, PARENT = "4bf92f3577b34da6a3ce929d0e0e4736", "00f067aa0ba902b7"
TRACEPARENT = f"00-{TRACE}-{PARENT}-01"


@pytest.fixture
def receiver(monkeypatch):
    with trace_receiver() as found:
        monkeypatch.setenv("OTEL_EXPORTER_OTLP_ENDPOINT", found.address)
        monkeypatch.setenv("OTEL_BSP_SCHEDULE_DELAY", "100")
        span_provider.cache_clear()
        yield found
        flush_spans()
        span_provider.cache_clear()


@pytest.fixture
def log(tmp_path, monkeypatch):
    file = tmp_path / "service.log"
    with file.open("w", buffering=1) as stream:
        monkeypatch.setattr("sys.stderr", stream)
        log_to_standard_error()
        yield file


def lines(log: Path, text: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in log.read_text().splitlines() if text in line]


def test_one_trace_leads_from_the_client_to_the_stages_of_the_worker(receiver, tmp_path, monkeypatch):
    """The scheduler is slow to note the worker it launched, as on a machine with other work."""
    monkeypatch.setattr(WorkerFigures, "started", lambda *_: time.sleep(0.5))
    app = create_app(Settings(data_directory=tmp_path), REGISTRY)
    own = TracerProvider().get_tracer("test")
    with served(app) as port, LineOfActionClient(f"http://127.0.0.1:{port}") as client:
        with own.start_as_current_span("designer") as designer:
            job = client.submit("fake", {"wish": {"mode": "slow", "text": "traced"}})
        client.wait(job.id)
        until(lambda: bool(receiver.named("settle")))
    context = designer.get_span_context()
    trace, caller = f"{context.trace_id:032x}", f"{context.span_id:016x}"
    (request,) = receiver.named(f"POST {EXECUTION}")
    (queue,), (attempt,), (settle,) = (receiver.named(n) for n in ("queue", "attempt fake", "settle"))
    assert (request.trace, request.parent) == (trace, caller)
    assert {span.trace for span in (queue, attempt, settle)} == {trace}
    assert {span.parent for span in (queue, attempt, settle)} == {request.id}
    stages = sorted((s for s in receiver.spans if s.parent == attempt.id), key=lambda s: s.begun)
    assert [stage.name for stage in stages] == ["start", "first", "second"]
    assert all(abs(after.begun - before.ended) < 1e-5 for before, after in pairwise(stages))
    assert queue.begun <= queue.ended <= attempt.begun <= stages[0].begun + 1e-5
    assert stages[-1].ended <= attempt.ended + 1e-5 and attempt.ended <= settle.begun + 1e-5
    assert stages[2].ended - stages[2].begun > 0.9  # it sleeps for a second
    spent = [stage.facts["loa.cpu_s"] for stage in stages]
    assert min(spent) >= 0.0
    assert sum(spent) == pytest.approx(attempt.facts["loa.cpu_s"], rel=1e-6)
    assert attempt.facts["loa.outcome"] == "done" and not attempt.failed
    assert receiver.services == {"lineofaction"}


def test_an_attempt_that_died_keeps_its_stages_and_another_follows(receiver, client):
    body = {"inputs": {"wish": {"mode": "die_once"}}}
    location = client.post(EXECUTION, json=body).headers["location"]
    until(lambda: client.get(location).json()["status"] == "successful")
    until(lambda: len(receiver.named("attempt fake")) == 2)
    first, second = sorted(receiver.named("attempt fake"), key=lambda span: span.begun)
    assert (first.facts["loa.outcome"], first.failed) == ("died", True)
    assert (second.facts["loa.outcome"], second.failed) == ("done", False)
    assert [s.name for s in receiver.spans if s.parent == first.id] == ["start", "first"]
    assert len(receiver.named("queue")) == 2
    assert len({span.trace for span in receiver.named("queue")}) == 1


def test_probes_leave_no_spans(receiver, client):
    for path in ("/health", "/ready", "/metrics"):
        assert client.get(path).status_code == 200
    client.get("/v1/jobs")
    until(lambda: bool(receiver.spans))
    assert {span.name for span in receiver.spans} == {"GET /v1/jobs"}


def test_without_a_receiver_the_callers_identifiers_are_kept_all_the_same(log, tmp_path):
    with TestClient(create_app(Settings(data_directory=tmp_path / "data"), REGISTRY)) as client:
        headers = {"X-Request-ID": "order-4711", "traceparent": TRACEPARENT}
        answer = client.post(EXECUTION, json={"inputs": {"wish": {"mode": "write"}}}, headers=headers)
        until(lambda: client.get(answer.headers["location"]).json()["status"] == "successful")
    assert answer.headers["x-request-id"] == "order-4711"
    assert answer.headers["traceparent"] == TRACEPARENT
    assert {line["event"] for line in lines(log, "order-4711")} == {"request", "job entered"}
    events = {line["event"] for line in lines(log, f'"trace_id": "{TRACE}"')}
    assert events == {"request", "job entered", "worker started", "worker ended"}


@pytest.mark.parametrize(
    "identifier", ["", "a" * 65, 'x", "event": "forged', "<script>", "a b", "../../etc", "ä"]
)
def test_an_identifier_that_could_harm_a_log_is_replaced(identifier, client):
    answer = client.get("/health", headers={"X-Request-ID": identifier.encode()})
    assert answer.headers["x-request-id"] not in ("", identifier)
    assert len(answer.headers["x-request-id"]) == 12


@pytest.mark.parametrize(
    "sent",
    [
        "",
        "00",
        f"ff-{TRACE}-{PARENT}-01",
        f"00-{'0' * 32}-{PARENT}-01",
        f"00-{TRACE}-{'0' * 16}-01",
        f"00-{TRACE.upper()}-{PARENT}-01",
        f"00-{TRACE}-{PARENT}-01\u0661",
        f"{TRACEPARENT}-more",
    ],
)
def test_what_is_no_traceparent_is_left_out(sent, client):
    answer = client.get("/health", headers={"traceparent": sent.encode()})
    assert answer.status_code == 200
    assert "traceparent" not in answer.headers


def test_no_span_no_header(client):
    assert "traceparent" not in client.get("/v1/jobs").headers


def test_nothing_of_opentelemetry_is_loaded_by_the_client_and_its_sdk_by_nobody_unasked():
    script = (
        "import sys\n"
        "from lineofaction.client import LineOfActionClient\n"
        "from lineofaction.client.exchange import traced\n"
        "assert traced({'json': 1}) == {'json': 1}\n"
        "assert not [name for name in sys.modules if name.startswith('opentelemetry')]\n"
        "import lineofaction.cli.serve, service.app\n"
        "from service.tracing import begun_span\n"
        "assert not begun_span('queue', '', 0.0).is_recording()\n"
        "assert not [name for name in sys.modules if name.startswith('opentelemetry.sdk')]\n"
    )
    done = subprocess.run([sys.executable, "-c", script], check=False, cwd=Path(__file__).parents[2])
    assert done.returncode == 0


def test_without_the_extra_the_log_says_what_to_install(log, monkeypatch):
    monkeypatch.setenv("OTEL_EXPORTER_OTLP_ENDPOINT", "http://127.0.0.1:9")
    monkeypatch.setitem(sys.modules, "opentelemetry.sdk.trace", None)
    span_provider.cache_clear()
    flush_spans()
    assert current_traceparent("sent") == "sent"
    span_provider.cache_clear()
    (line,) = lines(log, "no traces")
    assert "lineofaction[telemetry]" in str(line["reason"])


def test_an_exporter_that_is_left_to_others_is_named(log, monkeypatch):
    monkeypatch.setenv("OTEL_TRACES_EXPORTER", "zipkin")
    monkeypatch.setenv("OTEL_EXPORTER_OTLP_ENDPOINT", "http://127.0.0.1:9")
    span_provider.cache_clear()
    assert not begun_span("queue", "", 0.0).is_recording()
    span_provider.cache_clear()
    (line,) = lines(log, "no traces")
    assert "OTEL_TRACES_EXPORTER=zipkin" in str(line["reason"])


# The log: from the identifier of a request to the worker that did the work, one text at a time.


def only(lines: list[dict[str, Any]], event: str) -> dict[str, Any]:
    (found,) = [line for line in lines if line["event"] == event]
    return found


@pytest.mark.law
def test_a_request_is_followed_to_its_worker_and_what_that_took(log, tmp_path):
    settings = Settings(data_directory=tmp_path / "data", attempts=2, memory_limit_mb=1000)
    with TestClient(create_app(settings, REGISTRY)) as client:
        answers = {}
        for mode in ("hog", "die_once"):
            body = {"inputs": {"wish": {"mode": mode}}}
            answers[mode] = client.post(EXECUTION, json=body)
            until(
                lambda where=answers[mode].headers["location"]: (
                    client.get(where).json()["status"] == "successful"
                )
            )
        shared = client.post(EXECUTION, json={"inputs": {"wish": {"mode": "hog"}}})
    entered = {
        mode: only(lines(log, answer.headers["x-request-id"]), "job entered")
        for mode, answer in answers.items()
    }
    assert entered["hog"]["job"] == answers["hog"].json()["jobID"]
    trail = lines(log, entered["hog"]["computation"])
    started, ended = only(trail, "worker started"), only(trail, "worker ended")
    (worker,) = (tmp_path / "data").glob(f"started_{entered['hog']['key'][:8]}")
    assert started["pid"] == ended["pid"] == int(worker.read_text().split()[0])
    assert (ended["outcome"], ended["attempt"], ended["process"]) == ("done", 1, "fake")
    assert ended["peak_mb"] > 300.0  # what it held
    assert ended["cpu_s"] > 0.0 and ended["seconds"] > 0.0
    again = [
        (line["outcome"], line["attempt"])
        for line in lines(log, entered["die_once"]["computation"])
        if line["event"] == "worker ended"
    ]
    assert again == [("died", 1), ("done", 2)]
    small = [line["peak_mb"] for line in lines(log, entered["die_once"]["computation"]) if "peak_mb" in line]
    assert 0.0 < small[-1] < ended["peak_mb"] - 250.0
    of_shared = only(lines(log, shared.headers["x-request-id"]), "job entered")
    assert of_shared["stored"] and of_shared["key"] == entered["hog"]["key"]


def test_what_ends_a_worker_is_named(log, tmp_path):
    settings = Settings(data_directory=tmp_path / "data")
    with TestClient(create_app(settings, REGISTRY)) as client:
        unwanted = client.post(EXECUTION, json={"inputs": {"wish": {"mode": "hang", "text": "unwanted"}}})
        until(lambda: lines(log, "worker started") != [])
        client.delete(unwanted.headers["location"])
        until(lambda: lines(log, "worker ended") != [])
    hurried = settings.model_copy(update={"deadline_s": 0.5})
    with TestClient(create_app(hurried, REGISTRY)) as client:
        late = client.post(EXECUTION, json={"inputs": {"wish": {"mode": "hang", "text": "late"}}})
        until(lambda: client.get(late.headers["location"]).json()["status"] == "failed")
    outcomes = {}
    for name, answer in (("late", late), ("unwanted", unwanted)):
        entered = only(lines(log, answer.headers["x-request-id"]), "job entered")
        outcomes[name] = only(lines(log, entered["computation"]), "worker ended")["outcome"]
    assert outcomes == {"late": "too late", "unwanted": "not wanted"}
