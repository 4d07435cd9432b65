"""Force queries of one point beside two jobs, of one serving process and of four on one socket."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from statistics import median, quantiles

from benchmarks.example_pair import PAIR, TORQUES
from benchmarks.figures import Figure
from benchmarks.fresh_process import measure
from benchmarks.service_process import family_cpu_seconds, idle_memory_mb, running
from service.store.places import stored_results

KEY = "ab" * 32
CALLERS, SECONDS, ROUNDS = 16, 4.0, 3
_TABLE = (
    PAIR + 'analyze(pair, torques={torques}, model="plane_strain").to_netcdf({table!r})\nmeasured = {{}}\n'
)
_JOB = "import os\nos.nice(10)\nwhile True:\n    sum(range(100_000))"


def figures() -> list[Figure]:
    """Ask a service of one process and one of four, in alternation; the fastest round of each counts."""
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        services = []
        table = Path(folder) / "ste.nc"
        for processes in (1, 4):
            directory = Path(folder) / str(processes)
            measure(_TABLE.format(torques=list(TORQUES), table=str(table)))
            stored_results(directory).put(KEY, "database", table)
            options = ["--processes", str(processes)]
            address, process, _ = stack.enter_context(running(directory, options=options))
            services.append((processes, int(address.rpartition(":")[2]), process.pid))
        for _, port, pid in services:
            idle_memory_mb(pid)
            _load(port, pid, 4 * CALLERS)  # every process reads the table
        with _jobs():
            rounds = [[_load(port, pid) for _, port, pid in services] for _ in range(ROUNDS)]
    taken = [min(each, key=lambda figure: figure["between"]) for each in zip(*rounds, strict=True)]
    return [
        figure
        for (number, *_), best in zip(services, taken, strict=True)
        for figure in _figures(number, best)
    ]


def _figures(processes: int, best: dict[str, float]) -> Iterator[Figure]:
    """Yield the figures of a service."""
    subject = f"one-point queries, {CALLERS} callers, two jobs, {processes} serving processes"
    yield Figure(subject, "time between answers", 1e6 * best["between"], "us", 1e6 / 3000.0)
    yield Figure(subject, "CPU time of the service for one", 1e6 * best["service"], "us")
    yield Figure(subject, "CPU time of the caller for one", 1e6 * best["caller"], "us")
    yield Figure(subject, "latency, median", 1e3 * best["median"], "ms")
    yield Figure(subject, "latency, 99 %", 1e3 * best["latest"], "ms", 10.0)


def _load(port: int, pid: int, callers: int = CALLERS) -> dict[str, float]:
    """Ask for a while; seconds for one query, by the clock and of CPU time."""
    cpu = family_cpu_seconds(pid)
    command = [sys.executable, "-m", "benchmarks.query_load", str(port), KEY, str(callers), str(SECONDS)]
    answer = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    cpu, latencies = family_cpu_seconds(pid) - cpu, answer["latency_s"]
    return {
        "between": answer["elapsed_s"] / len(latencies),
        "service": cpu / len(latencies),
        "caller": answer["cpu_s"] / len(latencies),
        "median": median(latencies),
        "latest": quantiles(latencies, n=100)[-1],
    }


@contextmanager
def _jobs() -> Iterator[None]:
    """Let two processes of a job's priority compute."""
    jobs = [subprocess.Popen([sys.executable, "-c", _JOB]) for _ in range(2)]
    try:
        yield
    finally:
        for job in jobs:
            job.kill()
            job.wait()
