"""Processes that die under a job: its mesher, its worker, and its worker every time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress

import numpy as np

from fe_contact.analysis import ste_database
from fe_contact.types import FloatArray
from host import halt
from host import kill as end
from lineofaction.gearbox.convert.case import analysis_options, gear_pair, table_axes
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.hardcases.jobs.aftermath import MEDIUM, aftermath, largest_difference
from lineofaction.hardcases.jobs.job_service import Disturb, JobService
from lineofaction.hardcases.jobs.limits import AFTER
from lineofaction.hardcases.scene import HardScene, Measured
from service.queue.job import Job

MESHER_COMMAND, WORKER_COMMAND = "gmsh_worker", "service.worker."
"""What their commands hold; a worker is started anew or forked."""


def _kill_meshers(times: int, killed: list[int]) -> Disturb:
    """Return what kills so many meshers as they run, and notes them."""

    def kill(service: JobService, _job: Job) -> None:
        if len(killed) < times:
            killed.extend(_reached(end, service.processes(MESHER_COMMAND)))

    return kill


def _kill_workers(times: int, killed: list[int]) -> Disturb:
    """Return what kills so many workers while their mesher runs, and notes them.

    The mesher is stopped first: it would be left for ever if nobody ended it.
    """

    def kill(service: JobService, _job: Job) -> None:
        if len(killed) < times and _reached(halt, service.processes(MESHER_COMMAND)):
            killed.extend(_reached(end, service.processes(WORKER_COMMAND)))

    return kill


def _reached(act: Callable[[int], None], processes: Sequence[int]) -> list[int]:
    """Act on processes; return those that were there."""
    reached = []
    for pid in processes:
        with suppress(ProcessLookupError):
            act(pid)
            reached.append(pid)
    return reached


def _mesher_killed() -> Sequence[Measured]:
    killed: list[int] = []
    outcome = aftermath(MEDIUM, _kill_meshers(1, killed))
    stated = "gmsh worker: killed by SIGKILL" in outcome.job.message
    return (
        Measured("meshers killed", float(len(killed)), 1.0, 1.0),
        Measured("failed at the first attempt", float(outcome.ended_as("failed", 1)), least=1.0),
        Measured("says that the mesh failed, and how", float(stated), least=1.0),
        *outcome.figures,
    )


def worker_killed_once() -> Sequence[Measured]:
    """Kill the first worker in mid-mesh."""
    killed: list[int] = []
    outcome = aftermath(MEDIUM, _kill_workers(1, killed))
    off = np.inf if outcome.errors is None else largest_difference(outcome.errors, of_python())
    return (
        Measured("workers killed", float(len(killed)), 1.0, 1.0),
        Measured("done at the second attempt", float(outcome.ended_as("successful", 2)), least=1.0),
        Measured("result off that of Python, m", off, most=0.0),
        *outcome.figures,
    )


def _worker_killed_always() -> Sequence[Measured]:
    """Kill every worker in mid-mesh."""
    killed: list[int] = []
    outcome = aftermath(MEDIUM, _kill_workers(2, killed))
    message = outcome.job.message
    stated = "ended by SIGKILL" in message and message.endswith("That was attempt 2 of 2.")
    return (
        Measured("workers killed", float(len(killed)), 2.0, 2.0),
        Measured("failed at the last attempt", float(outcome.ended_as("failed", 2)), least=1.0),
        Measured("says what ended it, and how often it was tried", float(stated), least=1.0),
        *outcome.figures,
    )


def of_python() -> FloatArray:
    """Return the transmission errors of the job, computed here."""
    case = validated(Case, MEDIUM)
    return ste_database(gear_pair(case), table_axes(case), analysis_options(case)).static_transmission_error


MESHER = HardScene(
    "job_whose_mesh_fails",
    "service",
    "The mesher is killed in mid-mesh: a process started by the worker, of which the service knows nothing.",
    f"The job fails at its first attempt and says that the mesher was killed; {AFTER}",
    _mesher_killed,
)
WORKER_ONCE = HardScene(
    "worker_killed_once",
    "service",
    "The worker is killed (SIGKILL) while its mesher hangs: nobody tells the service, and the mesher stays.",
    f"The second attempt gives what Python gives undisturbed, to the last bit; {AFTER}",
    worker_killed_once,
)
WORKER_ALWAYS = HardScene(
    "worker_killed_at_every_attempt",
    "service",
    "Every worker of the job is killed while its mesher hangs: tried for ever, it would block all others.",
    f"The job fails at its second attempt, with the signal and the number of attempts; {AFTER}",
    _worker_killed_always,
)
