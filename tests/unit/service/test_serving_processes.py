"""The command line in a process of its own: serving, stopping, interrupting."""

import errno
import json
import os
import signal
import socket
import subprocess
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from command_line import loa
from own_process import ROOT, children, cpu_seconds, python
from running_service import PATIENCE_S, lives, until

LOA = ("-m", "lineofaction.cli")


@contextmanager
def serving(folder: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Serve on a free port; gives the process and its address."""
    process = python(*LOA, "serve", "--port", 0, "--data-directory", folder, stderr=subprocess.PIPE)
    line = process.stdout.readline()
    assert line, process.communicate()
    yield process, line.rpartition(" ")[2].strip()
    if process.poll() is None:
        process.kill()
    process.communicate()


@pytest.fixture
def server(tmp_path):
    with serving(tmp_path / "served") as found:
        yield found


@pytest.fixture(scope="module")
def lasting(tmp_path_factory):
    """The data directory and the address of a server that all tests of the file may ask."""
    folder = tmp_path_factory.mktemp("service") / "served"
    with serving(folder) as (_, address):
        until(lambda: _healthy(address))
        yield folder, address


def test_a_server_starts_serves_and_stops_clean(server):
    process, address = server
    host, _, port = address.removeprefix("http://").rpartition(":")
    socket.create_connection((host, int(port)), timeout=PATIENCE_S).close()  # it listens before it says so
    until(lambda: _healthy(address))
    until(lambda: _is_idle(process.pid))  # its libraries are loaded
    before = cpu_seconds(process.pid)
    process.send_signal(signal.SIGTERM)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0
    assert "Traceback" not in process.communicate()[1]
    # what the promise of 5 s beside 20 busy processes on 2 cores leaves: a tenth of that
    assert usage.ru_utime + usage.ru_stime - before < 0.25


def _is_idle(pid: int) -> bool:
    """Whether a process takes next to no CPU time for a while, and not for want of a processor."""
    before = cpu_seconds(pid)
    for _ in range(20):
        time.sleep(0.05)
        if any(_state(task) == "R" for task in Path(f"/proc/{pid}/task").iterdir()):
            return False
    return cpu_seconds(pid) - before < 0.02


def _state(task: Path) -> str:
    """Return the state of a thread: R runs or waits for its turn."""
    try:
        return (task / "stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:  # it has ended
        return ""


def _healthy(address: str) -> bool:
    try:
        with urllib.request.urlopen(f"{address}/health", timeout=PATIENCE_S) as answer:
            return bool(answer.status == 200)
    except OSError:
        return False


@pytest.mark.law
def test_a_stopped_server_leaves_no_worker(server, tmp_path):
    process, address = server
    until(lambda: _healthy(address))
    job = loa("submit", ROOT / "examples/palermo_spur_20_20.toml", "--service", address, "--json")
    assert json.loads(job.stdout)["process"] == "analyze"
    workers: list[int] = []

    def found():
        workers.extend(children(process.pid))
        return bool(workers)

    until(found)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0
    until(lambda: not any(lives(pid) for pid in workers))
    modes = {
        path: path.stat().st_mode & 0o777 for path in [tmp_path / "served", *(tmp_path / "served").rglob("*")]
    }
    assert {path: mode for path, mode in modes.items() if mode != (0o700 if path.is_dir() else 0o600)} == {}


def test_a_second_server_in_the_same_directory_is_refused(lasting):
    result = loa("serve", "--port", "0", "--data-directory", lasting[0])
    assert result.exit_code == 2
    assert "another service works in it" in result.stderr


def test_a_port_in_use_is_said(lasting, tmp_path):
    port = lasting[1].rpartition(":")[2]
    result = loa("serve", "--port", port, "--data-directory", tmp_path / "other")
    assert result.exit_code == 2
    assert f"port = {port}: must be a free port" in result.stderr


def test_interrupting_is_clean(tmp_path):
    fifo = tmp_path / "case.toml"
    os.mkfifo(fifo)  # the command waits for its case, so the signal comes while it works
    process = python(*LOA, "analyze", fifo, "-o", tmp_path / "ste.nc", stderr=subprocess.PIPE)
    writer: list[int] = []

    def reads():
        assert process.poll() is None, process.communicate()
        try:
            writer.append(os.open(fifo, os.O_WRONLY | os.O_NONBLOCK))
        except OSError as error:
            assert error.errno == errno.ENXIO  # nobody reads yet
        return bool(writer)

    try:
        until(reads)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=PATIENCE_S)
    finally:
        process.kill()
        for descriptor in writer:
            os.close(descriptor)
    assert process.returncode == 130
    assert said == "interrupted\n"
