"""Cost of the 64 x 12 table of the 20/20 pair in CPU seconds, the mesher's process included."""

from __future__ import annotations

import tempfile
from statistics import median

from benchmarks.example_pair import PAIR, TORQUES
from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

_REPEATS = 3
_CODE = (
    PAIR
    + """
import json, resource, time
from pathlib import Path
def cpu():
    used = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(u.ru_utime + u.ru_stime for u in used)
def table():
    start = cpu()
    database = analyze(pair, torques={torques}, positions=64, model="plane_strain", cache=Path({cache!r}))
    return cpu() - start, database
cold, database = table()
cached, _ = table()
peak = database.metadata.receipt["peak_memory_bytes"]
measured = {{"cold": cold, "cached": cached, "failed": database.n_failed, "peak": peak}}
"""
)


def figures() -> list[Figure]:
    """Return the median of several fresh processes."""
    runs = [_run() for _ in range(_REPEATS + 1)][1:]  # the first one may compile
    middle = {name: median(run[name] for run in runs) for name in runs[0]}
    subject = "64 x 12 table, 2-D"
    return [
        Figure(subject, "cold: meshes, finite elements, contact", middle["cold"], "CPU s", 3.0),
        Figure(subject, "with cached compliance", middle["cached"], "CPU s", 0.2),
        Figure(subject, "whole process, both tables, imports", middle["process_cpu_seconds"], "CPU s"),
        Figure(subject, "failed", middle["failed"], "points", 0.0),
        Figure(subject, "peak memory", middle["peak"] / 2**20, "MiB"),
    ]


def _run() -> dict[str, float]:
    """One process with an empty cache of compliances."""
    with tempfile.TemporaryDirectory() as cache:
        return measure(_CODE.format(torques=list(TORQUES), cache=cache))
