"""Jobs that lack memory, time or space, and jobs whose processes die."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np

from fe_contact.analysis.analyze import ste_database
from fe_contact.types import FloatArray
from host import kill as end
from host import limit_file_size, memory_figure
from lineofaction.gearbox.convert.case import analysis_options, gear_pair, table_axes
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.hardcases.jobs.aftermath import (
    LARGE,
    LONG,
    MEDIUM,
    Aftermath,
    JobService,
    aftermath,
    largest_difference,
    undisturbed,
)
from lineofaction.hardcases.scene import Measured, Scenes
from service.queue.job import Job

SCENES = Scenes("service")

MEMORY_MB = 384
"""Half-way, in proportion, between what the small job needs and what the large one does."""


AFTER = (
    "nothing of it is left, and the jobs behind it end as they should, in their turn, with results that are "
    "those of an undisturbed service to the last bit."
)


@SCENES.add(
    "job_out_of_memory",
    "A three-dimensional analysis that needs three times the memory a worker may have: an allocation fails "
    "somewhere in numerical libraries.",
    f"The job fails at its first attempt, with the limit and what to try; {AFTER}",
)
def _out_of_memory() -> Sequence[Measured]:
    """Run the large job with little memory."""
    outcome = aftermath(LARGE, settle=lambda _seconds: {"memory_limit_mb": MEMORY_MB})
    job = outcome.job
    stated = f"{MEMORY_MB} MB (LOA_MEMORY_LIMIT_MB)" in job.message and "coarser level" in job.message
    return (
        Measured("failed at the first attempt", float(outcome.ended_as("failed", 1)), least=1.0),
        Measured("names the limit and what to try", float(stated), least=1.0),
        *outcome.figures,
    )


@SCENES.add(
    "job_past_deadline",
    "A job that is inside compiled code when its deadline passes, and hears of nothing.",
    f"The job fails at its first attempt, with the deadline and what to try; {AFTER}",
)
def _past_the_deadline() -> Sequence[Measured]:
    """Run the large job with a deadline of a few times what the small one takes."""
    allowed = []

    def settle(seconds: float) -> dict[str, float]:
        allowed.append(round(2.5 * seconds, 1))
        return {"deadline_s": allowed[0]}

    outcome = aftermath(LONG, settle=settle)
    job = outcome.job
    stated = f"The deadline of {allowed[0]:g} s (LOA_DEADLINE_S) passed" in job.message
    return (
        Measured("failed at the first attempt", float(outcome.ended_as("failed", 1)), least=1.0),
        Measured("names the deadline and what to try", float(stated and "coarser" in job.message), least=1.0),
        Measured("deadline, s", allowed[0]),
        *outcome.figures,
    )


# Processes that die under a job: its mesher, its worker, and its worker every time.


MESHER_COMMAND, WORKER_COMMAND = "gmsh_worker", "service.worker."
"""What their commands hold; a worker is started anew or forked."""


_HANGING = """
import time
time.sleep(3600.0)
"""
"""A mesher that is met, however short its mesh."""


@contextmanager
def _mesher_that(does: str) -> Iterator[Path]:
    """Put what the mesher loads first on the path of the workers, which hand it on; undone once unlinked."""
    undisturbed()
    before = os.environ.get("PYTHONPATH")
    with tempfile.TemporaryDirectory(prefix="loa-hard-mesher-") as name:
        stand_in = Path(name, "gmsh.py")
        stand_in.write_text(does, encoding="utf-8")
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (name, before)))
        try:
            yield stand_in
        finally:
            os.environ.pop("PYTHONPATH") if before is None else os.environ.update(PYTHONPATH=before)


def _killing(command: str, times: int) -> tuple[Aftermath, int]:
    """Kill the process of this command each time the mesher hangs; returns how often it was."""
    killed: list[int] = []
    with _mesher_that(_HANGING) as hangs:

        def kill(service: JobService, _job: Job) -> None:
            met = service.processes(command) if service.processes(MESHER_COMMAND) else []
            if met and len(killed) < times:
                if len(killed) + len(met) == times:
                    hangs.unlink()
                for pid in met:
                    with suppress(ProcessLookupError):
                        end(pid)
                        killed.append(pid)

        return aftermath(MEDIUM, kill), len(killed)


@SCENES.add(
    "job_whose_mesh_fails",
    "The mesher is killed in mid-mesh: a process started by the worker, of which the service knows nothing.",
    f"The job fails at its first attempt and says that the mesher was killed; {AFTER}",
)
def _mesher_killed() -> Sequence[Measured]:
    outcome, killed = _killing(MESHER_COMMAND, 1)
    stated = "gmsh worker: killed by SIGKILL" in outcome.job.message
    return (
        Measured("meshers killed", float(killed), 1.0, 1.0),
        Measured("failed at the first attempt", float(outcome.ended_as("failed", 1)), least=1.0),
        Measured("says that the mesh failed, and how", float(stated), least=1.0),
        *outcome.figures,
    )


@SCENES.add(
    "worker_killed_once",
    "The worker is killed (SIGKILL) while its mesher hangs: nobody tells the service, and the mesher stays.",
    f"The second attempt gives what Python gives undisturbed, to the last bit; {AFTER}",
)
def _worker_killed_once() -> Sequence[Measured]:
    """Kill the first worker in mid-mesh."""
    outcome, killed = _killing(WORKER_COMMAND, 1)
    off = np.inf if outcome.errors is None else largest_difference(outcome.errors, _of_python())
    return (
        Measured("workers killed", float(killed), 1.0, 1.0),
        Measured("done at the second attempt", float(outcome.ended_as("successful", 2)), least=1.0),
        Measured("result off that of Python, m", off, most=0.0),
        *outcome.figures,
    )


@SCENES.add(
    "worker_killed_at_every_attempt",
    "Every worker of the job is killed while its mesher hangs: tried for ever, it would block all others.",
    f"The job fails at its second attempt, with the signal and the number of attempts; {AFTER}",
)
def _worker_killed_always() -> Sequence[Measured]:
    """Kill every worker in mid-mesh."""
    outcome, killed = _killing(WORKER_COMMAND, 2)
    message = outcome.job.message
    stated = "ended by SIGKILL" in message and message.endswith("That was attempt 2 of 2.")
    return (
        Measured("workers killed", float(killed), 2.0, 2.0),
        Measured("failed at the last attempt", float(outcome.ended_as("failed", 2)), least=1.0),
        Measured("says what ended it, and how often it was tried", float(stated), least=1.0),
        *outcome.figures,
    )


def _of_python() -> FloatArray:
    case = validated(Case, MEDIUM)
    return ste_database(gear_pair(case), table_axes(case), analysis_options(case)).static_transmission_error


# Jobs whose disk takes nothing more, and whose mesher takes memory without end.


_MB = 1 << 20
_DEVOURS = """
held = []
while True:
    held.append(b"x" * 2**22)
"""


@SCENES.add(
    "job_without_disk_space",
    "No write of the worker succeeds any more, as on a full disk: libraries that write may crash.",
    "The job fails at its first attempt, with the cause and what to try, and serves nothing; submitted again "
    f"with room it gives what Python gives, to the last bit; {AFTER}",
)
def _disk_full() -> Sequence[Measured]:
    """Let no write of the worker succeed, then submit the job again."""
    held: list[int] = []

    def fill(service: JobService, _job: Job) -> None:
        for pid in service.processes(WORKER_COMMAND) if not held else ():
            with suppress(ProcessLookupError):
                limit_file_size(pid, 0)
                held.append(pid)

    outcome = aftermath(MEDIUM, fill, resubmit=True)
    stated = "no space left" in outcome.job.message and "Make room" in outcome.job.message
    off = np.inf if outcome.errors is None else largest_difference(outcome.errors, _of_python())
    return (
        Measured("workers without room", float(len(held)), 1.0, 1.0),
        Measured("failed at the first attempt", float(outcome.ended_as("failed", 1)), least=1.0),
        Measured("names the cause and what to try", float(stated), least=1.0),
        Measured("submitted again with room, off that of Python, m", off, most=0.0),
        *outcome.figures,
    )


@SCENES.add(
    "mesher_without_end",
    "The mesher, a process started by the worker that the service knows nothing of, takes memory without "
    "end.",
    f"It never has more than a worker may; the job fails at its first attempt, with the cause; {AFTER}",
)
def _greedy_mesher() -> Sequence[Measured]:
    """Let the first mesher take memory until the system gives it no more."""
    most = [0.0]
    with _mesher_that(_DEVOURS) as greed:

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
