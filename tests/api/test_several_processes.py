"""Several serving processes on one socket: one that is killed is replaced, jobs go on, all stop together."""

import http.client
import json
import os
import re
import signal
import socket
import subprocess
import threading
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from own_process import children, command, python
from running_service import PATIENCE_S, lives, until
from whole_service import CASE

from lineofaction.cli import serving_processes
from lineofaction.cli.serving_processes import ServingProcesses

NUMBER, CALLERS = 3, 6


@contextmanager
def serving(folder: Path, **settings: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Serve with several processes on a free port; gives the supervising process and the address."""
    serve = ("-m", "lineofaction.cli", "serve", "--port", 0, "--processes", NUMBER)
    with (folder / "log").open("w") as log:
        process = python(*serve, "--data-directory", folder / "data", settings=settings, stderr=log)
    address = process.stdout.readline().rpartition(" ")[2].strip()
    assert address, (folder / "log").read_text()
    try:
        get(address, "/health")
        yield process, address
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()


@pytest.fixture
def server(tmp_path):
    with serving(tmp_path) as found:
        yield found


def get(address: str, path: str) -> bytes:
    with urllib.request.urlopen(f"{address}{path}", timeout=PATIENCE_S) as answer:
        return bytes(answer.read())


def serving_pids(supervisor: int) -> list[int]:
    """Return the serving processes: children of the process that forks them."""
    forking = [pid for pid in children(supervisor) if b"forkserver import" in command(pid)]
    return [pid for fork in forking for pid in children(fork) if lives(pid)]


class Caller(threading.Thread):
    """Asks on a kept connection without a pause; where that breaks it goes on with another."""

    def __init__(self, address: str, ended: threading.Event) -> None:
        super().__init__()
        self._address, self._ended = address.removeprefix("http://"), ended
        self.answers: list[int] = []
        self.broken = 0

    def run(self) -> None:
        connection = http.client.HTTPConnection(self._address, timeout=PATIENCE_S)
        while not self._ended.is_set():
            try:
                connection.request("GET", "/v1/jobs?limit=1")
                answer = connection.getresponse()
                answer.read()
                self.answers.append(answer.status)
            except (OSError, http.client.HTTPException):
                self.broken += 1
                connection.close()
        connection.close()


@pytest.mark.law
def test_a_killed_process_is_replaced_and_loses_only_what_it_answers(server):
    process, address = server
    until(lambda: len(serving_pids(process.pid)) == NUMBER)
    job = _submitted(address)
    ended = threading.Event()
    callers = [Caller(address, ended) for _ in range(CALLERS)]
    for caller in callers:
        caller.start()
    until(lambda: all(len(caller.answers) > 20 for caller in callers))
    victims = list(serving_pids(process.pid))
    for victim in victims[:2]:
        os.kill(victim, signal.SIGKILL)
    until(lambda: len(set(serving_pids(process.pid)) - set(victims[:2])) == NUMBER)
    before = [len(caller.answers) for caller in callers]
    until(lambda: all(len(c.answers) > count + 20 for c, count in zip(callers, before, strict=True)))
    ended.set()
    for caller in callers:
        caller.join()
    assert all(set(caller.answers) == {200} for caller in callers)
    assert all(caller.broken <= 2 for caller in callers)  # a request for each process that was killed
    figures = get(address, "/metrics").decode()
    counted = re.search(r'loa_requests_total\{[^}]*route="/v1/jobs",status="200"} ([\d.]+)', figures)
    answered = sum(len(caller.answers) for caller in callers)
    # A process counts an answer after it is sent: killed in between, it leaves one that is not counted.
    uncounted = len(victims[:2])
    assert answered - uncounted <= float(counted.group(1)) <= answered + 2 * CALLERS
    until(lambda: _status(address, job)["status"] == "successful")
    assert _status(address, job)["attempts"] == 1


def _submitted(address: str) -> str:
    body = json.dumps({"inputs": {"case": CASE}}).encode()
    request = urllib.request.Request(
        f"{address}/v1/processes/analyze/execution", body, {"Content-Type": "application/json"}
    )
    with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
        return str(answer.headers["Location"])


def _status(address: str, job: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(get(address, job))
    return found


def test_all_stop_within_five_seconds_of_a_signal(server, tmp_path):
    process, address = server
    until(lambda: len(serving_pids(process.pid)) == NUMBER)
    job = _submitted(address)
    until(lambda: _status(address, job)["status"] == "running")
    stream = urllib.request.urlopen(f"{address}{job}/events", timeout=PATIENCE_S)
    family = [*children(process.pid), *serving_pids(process.pid)]
    begin = time.monotonic()
    process.send_signal(signal.SIGTERM)
    assert process.wait(PATIENCE_S) == 0
    assert time.monotonic() - begin < 5.0
    stream.read()  # it has ended
    until(lambda: not any(lives(pid) for pid in family))
    assert "Traceback" not in (tmp_path / "log").read_text()


def test_none_outlives_a_supervisor_that_is_killed(server):
    process, _ = server
    until(lambda: len(serving_pids(process.pid)) == NUMBER)
    family = [*children(process.pid), *serving_pids(process.pid)]
    process.kill()
    process.wait()
    until(lambda: not any(lives(pid) for pid in family))
    assert len(family) > NUMBER


def test_processes_that_die_at_once_are_not_started_again_and_again(monkeypatch):
    clock, started = [0.0], list[float]()
    dead = SimpleNamespace(is_alive=lambda: False, pid=1, exitcode=1)

    def start(_self):
        started.append(clock[0])
        return dead

    monkeypatch.setattr(ServingProcesses, "_started", start)
    monkeypatch.setattr(serving_processes, "mark_process_dead", lambda *_: None)
    monkeypatch.setenv("PROMETHEUS_MULTIPROC_DIR", "unused")
    monkeypatch.setattr(serving_processes.time, "monotonic", lambda: clock[0])
    processes = ServingProcesses(2, lambda: None)
    for _ in range(101):
        processes.replace_dead()
        clock[0] += 0.2
    assert (
        2 * 20.0 / serving_processes.MIN_LIFE_S
        <= len(started)
        <= 2 * (20.0 / serving_processes.MIN_LIFE_S + 1)
    )


def test_one_management_port_tells_of_all_processes_and_of_their_scheduler(tmp_path):
    with serving(tmp_path, LOA_MANAGEMENT_PORT="0") as (process, address):
        assert process.stdout is not None
        management = process.stdout.readline().rpartition(" ")[2].strip()
        until(lambda: len(serving_pids(process.pid)) == NUMBER)
        for _ in range(20):
            get(address, "/v1/jobs")
        assert json.loads(get(management, "/health")) == {"status": "ok"}
        until(lambda: json.loads(get(management, "/ready")) == {"status": "ready"})
        text = get(management, "/metrics").decode()
        assert re.search(r'loa_requests_total\{.*route="/v1/jobs",status="200".*\} 20\.0', text)
        assert "loa_scheduler_up 1.0" in text and "loa_workers_busy 0.0" in text
        names = [line.split()[2] for line in text.splitlines() if line.startswith("# TYPE")]
        assert len(set(names)) == len(names)
        with socket.create_connection(("127.0.0.1", int(address.rpartition(":")[2]))) as connection:
            connection.sendall(b"GET /health HTTP/1.1\r\nHost: localhost\r\n\r\n")
            assert connection.recv(100)
            until(lambda: "loa_connections 1.0" in get(management, "/metrics").decode())
            for pid in serving_pids(process.pid):
                os.kill(pid, signal.SIGKILL)
            until(lambda: "loa_connections 0.0" in get(management, "/metrics").decode())
