"""The management port: it tells health, readiness and metrics to those without a key, for both programs."""

import asyncio
import json
import socket
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import httpx2
import pytest
from own_process import python
from prometheus_client.parser import text_string_to_metric_families
from running_service import PATIENCE_S, bench, until
from service_fakes import REGISTRY

from lineofaction.gearbox.problems import BadInput
from service.access.key_file import KeyFile
from service.management import vitals
from service.management.server import ManagementServer
from service.management.vitals import EventLoop, Vitals
from service.store.deployment import Deployment
from service.store.write_check import WriteCheck


@contextmanager
def program(verb: str, folder: Path) -> Iterator[tuple[subprocess.Popen[str], list[str]]]:
    """Run `loa serve` with a management port; gives the process and its two lines."""
    settings = {"LOA_DATA_DIRECTORY": str(folder), "LOA_MANAGEMENT_PORT": "0", "LOA_PORT": "0"}
    process = python("-m", "lineofaction.cli", verb, settings=settings, stderr=subprocess.PIPE)
    assert process.stdout is not None
    try:
        lines = [process.stdout.readline(), process.stdout.readline()]
        yield process, [line.rpartition(" ")[2].strip() for line in lines]
    finally:
        process.kill()
        process.communicate()


def names(address: str) -> set[str]:
    answer = httpx2.get(f"{address}/metrics", timeout=PATIENCE_S)
    assert answer.headers["content-type"] == "text/plain; version=0.0.4; charset=utf-8"
    return {family.name for family in text_string_to_metric_families(answer.text)}


def connections(address: str) -> float:
    """Return how many HTTP connections there are, by the metrics at an address."""
    lines = httpx2.get(f"{address}/metrics", timeout=PATIENCE_S).text.splitlines()
    return float(next(line for line in lines if line.startswith("loa_connections ")).split()[1])


def status(address: str, path: str) -> int:
    with suppress(httpx2.TransportError):
        return httpx2.get(f"{address}{path}", timeout=PATIENCE_S).status_code
    return 0


def test_a_server_with_keys_tells_them_without_one(tmp_path):
    folder = tmp_path / "data"
    folder.mkdir(mode=0o700)
    KeyFile(folder / "keys.json").add("someone")
    with program("serve", folder) as (_, (public, address)):
        until(lambda: status(address, "/ready") == 200)
        assert status(public, "/metrics") == 401
        assert {"loa_workers_busy", "loa_requests", "loa_connections"} <= names(address)
        with httpx2.Client() as client:
            client.get(f"{public}/health")
            assert connections(address) == 1
        until(lambda: connections(address) == 0)
        assert status(address, "/v1/jobs") == 404


@pytest.fixture
def signs(tmp_path):
    """The signs of a running scheduler, and its data directory."""
    machine = bench(tmp_path, REGISTRY)
    machine.scheduler.start()
    yield Vitals(machine.scheduler, WriteCheck(Deployment(machine.engine, machine.store))), tmp_path
    machine.close()


def test_a_scheduler_that_ended_or_hangs_is_not_healthy(signs, monkeypatch):
    found, _ = signs
    assert found.fault_of_health() == found.fault_of_readiness() == ""
    hangs = threading.Event()
    monkeypatch.setattr(vitals, "TURN_WITHIN_S", 1.5)
    monkeypatch.setattr(type(found.scheduler), "_turn", lambda _self: hangs.wait())
    until(lambda: "has not turned" in found.fault_of_health())
    hangs.set()
    monkeypatch.undo()
    until(lambda: found.fault_of_health() == "")
    found.scheduler.stop()
    assert "does not run" in found.fault_of_health()
    assert "does not run" in found.fault_of_readiness()


def test_what_cannot_be_written_to_is_alive_but_not_ready(signs):
    found, folder = signs
    with ManagementServer("127.0.0.1", 0, found, bytes) as server:
        assert status(server.address, "/ready") == 200
        (folder / "results").rename(folder / "away")
        (folder / "results").write_text("no folder")
        until(lambda: status(server.address, "/ready") == 503)
        assert "results" in httpx2.get(f"{server.address}/ready").json()["detail"]
        assert status(server.address, "/health") == 200


def test_a_loop_of_requests_that_is_stuck_is_not_healthy():
    loop = EventLoop()
    assert loop.fault() == ""  # not yet begun
    loop.loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.loop.run_forever)
    thread.start()
    try:
        assert loop.fault() == ""
        freed = threading.Event()
        loop.loop.call_soon_threadsafe(freed.wait)
        assert "has not turned" in loop.fault()
        freed.set()
        until(lambda: loop.fault() == "")
    finally:
        freed.set()
        loop.loop.call_soon_threadsafe(loop.loop.stop)
        thread.join()
        loop.loop.close()


def test_a_port_in_use_is_said(signs):
    with socket.create_server(("127.0.0.1", 0)) as other, pytest.raises(BadInput) as caught:
        ManagementServer("127.0.0.1", other.getsockname()[1], signs[0], bytes)
    assert [fault.field for fault in caught.value.faults] == ["management_port"]


@pytest.mark.nightly
def test_connections_that_say_nothing_take_bounded_room(signs):
    before = threading.active_count()
    with ManagementServer("127.0.0.1", 0, signs[0], bytes) as server:
        host, _, port = server.address.removeprefix("http://").rpartition(":")
        silent = [socket.create_connection((host, int(port))) for _ in range(100)]
        time.sleep(0.2)
        assert threading.active_count() <= before + 18
        for connection in silent:
            connection.close()
        until(lambda: status(server.address, "/health") == 200)
        answer = httpx2.head(f"{server.address}/health")
        assert answer.content == b"" and answer.headers["content-length"] == str(
            len(json.dumps({"status": "ok"}))
        )
