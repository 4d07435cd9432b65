"""One caller does not stall the others: bodies that cost much, and connections that ask for nothing."""

from __future__ import annotations

import json
import socket
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing
from dataclasses import dataclass
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import httpx2
import pytest
from own_process import children, command, cpu_seconds, python
from running_service import PATIENCE_S

from host import family_cpu_seconds

pytestmark = pytest.mark.chain
WITHIN_S = 1.0  # the promise of docs/service.md
BYTES = 3_800_000
VITAL = ("/health", "/ready")


@dataclass(frozen=True)
class Process:
    """`loa serve` in a process of its own."""

    address: str
    pid: int
    log: Path

    @property
    def place(self) -> tuple[str, int]:
        host, _, port = self.address.removeprefix("http://").partition(":")
        return host, int(port)


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    """A service that has loaded what it needs to read bodies."""
    directory = tmp_path_factory.mktemp("stall")
    settings, log = {"LOA_DATA_DIRECTORY": str(directory / "data")}, directory / "log"
    serve = ("-m", "lineofaction.cli", "serve", "--port", 0)
    with log.open("wb") as stream, python(*serve, settings=settings, stderr=stream) as process:
        address = process.stdout.readline().rpartition(" ")[2].strip()
        try:
            answer = httpx2.post(f"{address}/v1/cases/from-toml", json={"toml": ""}, timeout=PATIENCE_S)
            assert answer.status_code == 422, answer.text
            yield Process(address, process.pid, log)
        finally:
            process.terminate()


def repeated(text: str) -> str:
    """Return a text as often as a body of the size of the attack holds it."""
    return text * (BYTES // len(text))


def toml(text: str) -> tuple[str, bytes]:
    return "/v1/cases/from-toml", json.dumps({"toml": text}).encode()


def execution(process: str, inputs: str) -> tuple[str, bytes]:
    return f"/v1/processes/{process}/execution", f'{{"inputs": {inputs}}}'.encode()


ATTACKS: dict[str, Callable[[], tuple[str, bytes]]] = {
    "faults in TOML": lambda: toml("[load]\ntorque_n_m = [" + repeated("'a',") + "]"),
    "tables in TOML": lambda: toml("".join(f"[a{number}]\n" for number in range(BYTES // 10))),
    "dotted keys in TOML": lambda: toml(
        "".join(f"{'.'.join('a' * 31)}.b{n}=1\n" for n in range(BYTES // 70))
    ),
    "faults in JSON": lambda: execution(
        "analyze", '{"case": {"load": {"torque_n_m": [' + repeated('"",') + "0]}}}"
    ),
    "tables in JSON": lambda: execution("simulate", '{"scene": {"shafts": [' + repeated("{},") + "{}]}}"),
    "texts for tables": lambda: execution("simulate", '{"scene": {"shafts": [' + repeated('"",') + "0]}}"),
    "unknown fields": lambda: execution(
        "analyze", '{"case": {' + ", ".join(f'"{n}": 0' for n in range(49_000)) + "}}"
    ),
}

FEW = ("faults in TOML", "faults in JSON")  # of the reading worker, and of the service
EACH = [pytest.param(kind, marks=[pytest.mark.nightly] * (kind not in FEW)) for kind in ATTACKS]


class Watch:
    """Asks for the service's health all the time.

    Attributes
    ----------
    longest_cpu_s : float
        Most CPU time that the service took meanwhile: the wait on a machine that does nothing else.
    """

    def __init__(self, service: Process) -> None:
        self._service, self._stop, self.longest_cpu_s = service, threading.Event(), 0.0
        self._threads = [threading.Thread(target=self._look, args=(path,)) for path in VITAL]

    def __enter__(self) -> Watch:
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        for thread in self._threads:
            thread.join()

    def _look(self, path: str) -> None:
        while not self._stop.is_set():
            cpu = cpu_seconds(self._service.pid)
            with closing(HTTPConnection(*self._service.place, timeout=PATIENCE_S)) as connection:
                connection.request("GET", path)
                answer = connection.getresponse()
                assert answer.status in (200, 503) and answer.read()  # ready or not, it says so
            self.longest_cpu_s = max(self.longest_cpu_s, cpu_seconds(self._service.pid) - cpu)
            self._stop.wait(0.1)

    def check(self) -> None:
        """Check the promise by what does not depend on what else the machine does."""
        assert 0.0 <= self.longest_cpu_s < WITHIN_S


def log_lines(service: Process) -> list[dict[str, Any]]:
    return [json.loads(line) for line in service.log.read_text().splitlines() if line.startswith("{")]


@pytest.mark.parametrize("kind", EACH)
def test_four_bodies_that_cost_much_hold_nobody_up(service, kind):
    path, body = ATTACKS[kind]()

    def post(_):
        headers = {"Content-Type": "application/json"}
        return httpx2.post(f"{service.address}{path}", content=body, headers=headers, timeout=PATIENCE_S)

    with Watch(service) as watch, ThreadPoolExecutor(4) as callers:
        answers = list(callers.map(post, range(4)))
    for answer in answers:
        assert answer.status_code in (413, 422)
        assert answer.headers["content-type"] == "application/problem+json"
        assert len(answer.json()["errors"]) <= 50 and len(answer.content) < 100_000
    watch.check()


def test_texts_are_read_by_other_processes(service):
    """The cause of what is seen above: the service has a lock that reading holds."""
    (warm,) = [pid for pid in children(service.pid) if b"reading.child" in command(pid)]
    spent = family_cpu_seconds(warm)
    assert spent is not None and spent - cpu_seconds(warm) > 1.0


def test_six_hundred_idle_connections_shut_nobody_out(service):
    with ExitStack() as idle:
        for _ in range(600):
            idle.enter_context(socket.create_connection(service.place, timeout=PATIENCE_S))
        with Watch(service) as watch:
            time.sleep(0.5)
        metrics = httpx2.get(f"{service.address}/metrics").text
    watch.check()
    (dropped,) = [line for line in metrics.splitlines() if line.startswith("loa_dropped_connections_total ")]
    assert float(dropped.split()[1]) >= 100


def test_refusals_are_counted_and_logged(service):
    body = b'{"toml": "' + b"[" * 60_000 + b'"}'
    headers = {"Content-Type": "application/json"}
    large = httpx2.post(f"{service.address}/v1/cases/from-toml", content=body, headers=headers)
    with socket.create_connection(service.place, timeout=PATIENCE_S) as connection:
        connection.sendall(b"nonsense\r\n\r\n")
        pieces = iter(lambda: connection.recv(65536), b"")
        head, _, problem = b"".join(pieces).partition(b"\r\n\r\n")
    assert large.status_code == 413 and "50000 lists" in large.json()["detail"]
    assert head.startswith(b"HTTP/1.1 400 ") and b"content-type: application/problem+json" in head
    assert json.loads(problem)["type"] == "urn:lineofaction:problem:malformed"
    metrics = httpx2.get(f"{service.address}/metrics").text
    for kind in ("too-large", "malformed"):
        assert f'loa_problems_total{{problem="{kind}"}}' in metrics
    identifiers = [large.headers["x-request-id"], head.partition(b"x-request-id: ")[2][:12].decode()]
    told = {line["request_id"]: line["problem"] for line in log_lines(service) if "problem" in line}
    assert [told[identifier] for identifier in identifiers] == ["too-large", "malformed"]
