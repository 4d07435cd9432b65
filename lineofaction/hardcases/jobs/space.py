"""Jobs whose disk takes nothing more, and whose mesher takes memory without end."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np

from host import limit_file_size, memory_figure
from lineofaction.hardcases.jobs.aftermath import MEDIUM, aftermath, largest_difference, undisturbed
from lineofaction.hardcases.jobs.deaths import MESHER_COMMAND, WORKER_COMMAND, of_python
from lineofaction.hardcases.jobs.job_service import Disturb, JobService
from lineofaction.hardcases.jobs.limits import AFTER, MEMORY_MB
from lineofaction.hardcases.scene import HardScene, Measured
from service.queue.job import Job

_MB = 1 << 20
_DEVOURER = """
held = []
while True:
    held.append(b"x" * 2**22)
"""
"""Stands in the mesher's way as the module that it loads first."""


def _no_room(held: list[int]) -> Disturb:
    """Return what keeps the first worker from writing to any file, by the system's limit on their size."""

    def fill(service: JobService, _job: Job) -> None:
        for pid in service.processes(WORKER_COMMAND) if not held else ():
            with suppress(ProcessLookupError):
                limit_file_size(pid, 0)
                held.append(pid)

    return fill


def _disk_full() -> Sequence[Measured]:
    """Let no write of the worker succeed, then submit the job again."""
    held: list[int] = []
    outcome = aftermath(MEDIUM, _no_room(held), resubmit=True)
    stated = "no space left" in outcome.job.message and "Make room" in outcome.job.message
    off = np.inf if outcome.errors is None else largest_difference(outcome.errors, of_python())
    return (
        Measured("workers without room", float(len(held)), 1.0, 1.0),
        Measured("failed at the first attempt", float(outcome.ended_as("failed", 1)), least=1.0),
        Measured("names the cause and what to try", float(stated), least=1.0),
        Measured("submitted again with room, off that of Python, m", off, most=0.0),
        *outcome.figures,
    )


@contextmanager
def _devouring_mesher() -> Iterator[Path]:
    """Put a mesher without end on the path of the workers, which hand it to what they start."""
    before = os.environ.get("PYTHONPATH")
    with tempfile.TemporaryDirectory(prefix="loa-hard-greedy-") as name:
        greed = Path(name, "gmsh.py")
        greed.write_text(_DEVOURER, encoding="utf-8")
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (name, before)))
        try:
            yield greed
        finally:
            os.environ.pop("PYTHONPATH") if before is None else os.environ.update(PYTHONPATH=before)


def _greedy_mesher() -> Sequence[Measured]:
    """Let the first mesher take memory until the system gives it no more."""
    undisturbed()
    most = [0.0]
    with _devouring_mesher() as greed:

        def look(service: JobService, _job: Job) -> None:
            for pid in service.processes(MESHER_COMMAND):
                most[0] = max(most[0], (memory_figure("VmData", pid) or 0) / _MB)

        def settle(_seconds: float) -> dict[str, float]:
            return {"memory_limit_mb": MEMORY_MB}

        def after(service: JobService, job: Job) -> None:
            look(service, job)
            if most[0] > 0.0 and not service.processes(MESHER_COMMAND):
                greed.unlink(missing_ok=True)

        outcome = aftermath(MEDIUM, after, settle)
    stated = "ran out of memory" in outcome.job.message and "coarser level" in outcome.job.message
    return (
        Measured("memory the mesher was seen with, MB", most[0], most=float(MEMORY_MB), least=64.0),
        Measured("failed at the first attempt", float(outcome.ended_as("failed", 1)), least=1.0),
        Measured("names the mesher's memory and what to try", float(stated), least=1.0),
        *outcome.figures,
    )


DISK_FULL = HardScene(
    "job_without_disk_space",
    "service",
    "No write of the worker succeeds any more, as on a full disk: libraries that write may crash.",
    "The job fails at its first attempt, with the cause and what to try, and serves nothing; submitted again "
    f"with room it gives what Python gives, to the last bit; {AFTER}",
    _disk_full,
)
GREEDY_MESHER = HardScene(
    "mesher_without_end",
    "service",
    "The mesher, a process started by the worker that the service knows nothing of, takes memory without "
    "end.",
    f"It never has more than a worker may; the job fails at its first attempt, with the cause; {AFTER}",
    _greedy_mesher,
)
