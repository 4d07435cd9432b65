"""Jobs whose disk takes nothing more, and whose mesher takes memory without end."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from host import limit_file_size, memory_figure
from lineofaction.hardcases.jobs.aftermath import MEDIUM, aftermath, largest_difference
from lineofaction.hardcases.jobs.disturbances import MEMORY_MB, RECOVERY
from lineofaction.hardcases.jobs.job_service import JobService
from lineofaction.hardcases.jobs.process_deaths import (
    MESHER_COMMAND,
    WORKER_COMMAND,
    python_ste,
    replaced_mesher,
)
from lineofaction.hardcases.scene import Measured, Scenes
from service.queue.job import Job

SCENES = Scenes("service")

_MB = 1 << 20

_DEVOURING = """
held = []
while True:
    held.append(b"x" * 2**22)
"""


@SCENES.add(
    "job_without_disk_space",
    "No write of the worker succeeds any more, as on a full disk: libraries that write may crash.",
    "The job fails at its first attempt, with the cause and what to try, and serves nothing; submitted again "
    f"with room it gives what Python gives, to the last bit; {RECOVERY}",
)
def _disk_full() -> Sequence[Measured]:
    """Let no write of the worker succeed, then submit the job again."""
    limited: list[int] = []

    def fill(service: JobService, _job: Job) -> None:
        for pid in service.processes(WORKER_COMMAND) if not limited else ():
            with suppress(ProcessLookupError):
                limit_file_size(pid, 0)
                limited.append(pid)

    outcome = aftermath(MEDIUM, fill, resubmit=True)
    is_explained = "no space left" in outcome.job.message and "Make room" in outcome.job.message
    off = np.inf if outcome.errors is None else largest_difference(outcome.errors, python_ste())
    return (
        Measured("workers without room", len(limited), maximum=1.0, minimum=1.0),
        Measured("failed at the first attempt", outcome.ended_as("failed", 1), minimum=1.0),
        Measured("names the cause and what to try", is_explained, minimum=1.0),
        Measured("submitted again with room, off that of Python, m", off, maximum=0.0),
        *outcome.figures,
    )


@SCENES.add(
    "mesher_without_end",
    "The mesher, a process started by the worker that the service knows nothing of, takes memory without "
    "end.",
    f"It never has more than a worker may; the job fails at its first attempt, with the cause; {RECOVERY}",
)
def _greedy_mesher() -> Sequence[Measured]:
    """Let the first mesher take memory until the system gives it no more."""
    maximum = [0.0]
    with replaced_mesher(_DEVOURING) as greedy_mesher:

        def look(service: JobService, _job: Job) -> None:
            for pid in service.processes(MESHER_COMMAND):
                maximum[0] = max(maximum[0], (memory_figure("VmData", pid) or 0) / _MB)

        def settle(_seconds: float) -> dict[str, float]:
            return {"memory_limit_mb": MEMORY_MB}

        def after(service: JobService, job: Job) -> None:
            look(service, job)
            if maximum[0] > 0.0 and not service.processes(MESHER_COMMAND):
                greedy_mesher.unlink(missing_ok=True)

        outcome = aftermath(MEDIUM, after, settle)
    is_explained = "ran out of memory" in outcome.job.message and "coarser level" in outcome.job.message
    return (
        Measured("memory the mesher was seen with, MB", maximum[0], maximum=float(MEMORY_MB), minimum=64.0),
        Measured("failed at the first attempt", outcome.ended_as("failed", 1), minimum=1.0),
        Measured("names the mesher's memory and what to try", is_explained, minimum=1.0),
        *outcome.figures,
    )
