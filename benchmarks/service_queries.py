"""Start, memory and force queries of the service, asked over loopback by this process."""

from __future__ import annotations

import http.client
import json
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median

import numpy as np

from benchmarks.example_pair import PAIR, TORQUES
from benchmarks.figures import Figure
from benchmarks.fresh_process import measure
from benchmarks.service_process import idle_memory_mb, memory_mb, running
from lineofaction.client import LineOfActionClient
from service.store.places import stored_results

KEY = "ab" * 32
PATH = f"/v1/databases/{KEY}/query"
RAW, JSON = "application/octet-stream", "application/json"
POINTS, BATCHES = 10_000, 30
_TABLE = (
    PAIR + 'analyze(pair, torques={torques}, model="plane_strain").to_netcdf({table!r})\nmeasured = {{}}\n'
)


def figures() -> list[Figure]:
    """Start a service on a fresh directory with one table, and ask it."""
    with tempfile.TemporaryDirectory() as folder:
        directory = Path(folder)
        table = directory / "ste.nc"
        measure(_TABLE.format(torques=list(TORQUES), table=str(table)))
        stored_results(directory).put(KEY, "database", table)
        with running(directory) as (address, process, started):
            at_start, idle = memory_mb(process.pid), idle_memory_mb(process.pid)
            with LineOfActionClient(address, cache_dir=directory / "cache") as client:
                client.query(KEY, [0.0], [5.0])  # reads the table, compiles where nothing is cached yet
                client.fetch(KEY)
                cached = min(_seconds(lambda: client.fetch(KEY)) for _ in range(5))
            batches = [*_batch_figures(address)]
            at_rest = memory_mb(process.pid)
    return [
        Figure("service", "start until it answers", started[0], "s", 3.0),
        Figure("service", "start until it answers, CPU time", started[1], "CPU s"),
        Figure("service", "memory when it answers", at_start, "MB"),
        Figure("service", "idle memory, libraries loaded", idle, "MB", 300.0),
        Figure("service", "memory after these queries", at_rest, "MB"),
        Figure("service", "cached table through the client", 1e3 * cached, "ms", 20.0),
        *batches,
    ]


def _batch_figures(address: str) -> Iterator[Figure]:
    """Time of a point in batches, with everything between question and answer in hand."""
    points = np.random.default_rng(1).uniform(0.0, 1.0, POINTS)
    deflection_um = np.random.default_rng(2).uniform(0.0, 15.0, POINTS)
    raw = np.array([points, deflection_um], dtype="<f8").tobytes()
    text = json.dumps({"position": points.tolist(), "deflection_um": deflection_um.tolist()}).encode()
    connection = _connection(address)
    for name, body, kind, limit in (("raw float64", raw, RAW, 0.5), ("JSON", text, JSON, 2.0)):
        ask = lambda body=body, kind=kind: _ask(connection, body, kind)  # noqa: E731
        ask()
        times = [1e6 * _seconds(ask) / POINTS for _ in range(BATCHES)]
        yield Figure("force queries", f"a point of {POINTS}, {name}, best", min(times), "us", limit)
        yield Figure("force queries", f"a point of {POINTS}, {name}, median", median(times), "us")
    connection.close()


def _connection(address: str) -> http.client.HTTPConnection:
    """Return a connection that is kept."""
    return http.client.HTTPConnection(address.removeprefix("http://"), timeout=60.0)


def _ask(connection: http.client.HTTPConnection, body: bytes, kind: str) -> bytes:
    """Post a query and read the answer."""
    connection.request("POST", PATH, body, {"Content-Type": kind})
    answer = connection.getresponse()
    content = answer.read()
    if answer.status != 200:
        raise RuntimeError(f"the service answered {answer.status}: {content[:500]!r}")
    return content


def _seconds(work: Callable[[], object]) -> float:
    """Return how long something takes."""
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin
