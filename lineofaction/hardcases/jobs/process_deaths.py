"""Processes that die under a job: its mesher, its worker, and its worker every time."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np

from fe_contact.analysis.analyze import analyze
from fe_contact.types import FloatArray
from host import kill as end
from lineofaction.gearbox.convert.case import analysis_options, gear_pair, table_axes
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.hardcases.jobs.aftermath import (
    MEDIUM,
    Aftermath,
    aftermath,
    largest_difference,
    undisturbed,
)
from lineofaction.hardcases.jobs.disturbances import RECOVERY
from lineofaction.hardcases.jobs.job_service import JobService
from lineofaction.hardcases.scene import Measured, Scenes
from service.queue.job import Job

SCENES = Scenes("service")

MESHER_COMMAND, WORKER_COMMAND = "gmsh_worker", "service.worker."
"""Texts in the commands of mesher and worker; a worker is started anew or forked."""

_HANGING = """
import time
time.sleep(3600.0)
"""
"""Program of a mesher that never ends, so that it runs when it is killed, however fast the mesh."""


@contextmanager
def replaced_mesher(program: str) -> Iterator[Path]:
    """Give workers a module `gmsh` of this text, which their mesher loads in place of the real one.

    Deleting the yielded file brings the real one back.
    """
    undisturbed()  # the small job runs with the real mesher
    before = os.environ.get("PYTHONPATH")
    with tempfile.TemporaryDirectory(prefix="loa-hard-mesher-") as name:
        module = Path(name, "gmsh.py")
        module.write_text(program, encoding="utf-8")
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (name, before)))
        try:
            yield module
        finally:
            os.environ.pop("PYTHONPATH") if before is None else os.environ.update(PYTHONPATH=before)


def _killing(
    command: str, times: int, *, as_crash: bool = False, overtaken: bool = False
) -> tuple[Aftermath, int]:
    """Run the medium job and kill its process of this command `times` times while its mesher hangs.

    Returns the aftermath and how many processes were killed; `overtaken` as in `aftermath`.
    """
    killed: list[int] = []
    with replaced_mesher(_HANGING) as hanging_mesher:

        def kill(service: JobService, _job: Job) -> None:
            targets = service.processes(command) if service.processes(MESHER_COMMAND) else []
            if targets and len(killed) < times:
                if len(killed) + len(targets) == times:  # the next mesher is the real one
                    hanging_mesher.unlink()
                for pid in targets:
                    with suppress(ProcessLookupError):
                        end(pid, as_crash=as_crash)
                        killed.append(pid)

        return aftermath(MEDIUM, kill, overtaken=overtaken), len(killed)


@SCENES.add(
    "job_whose_mesh_fails",
    "The mesher is killed in mid-mesh: a process started by the worker, of which the service knows nothing.",
    f"The job fails at its first attempt and says that the mesher was killed; {RECOVERY}",
)
def _mesher_killed() -> Sequence[Measured]:
    outcome, killed = _killing(MESHER_COMMAND, 1)
    is_explained = "gmsh worker: killed by SIGKILL" in outcome.job.message
    return (
        Measured("meshers killed", killed, maximum=1.0, minimum=1.0),
        Measured("failed at the first attempt", outcome.ended_as("failed", 1), minimum=1.0),
        Measured("says that the mesh failed, and how", is_explained, minimum=1.0),
        *outcome.figures,
    )


@SCENES.add(
    "worker_killed_once",
    "The worker is killed (SIGKILL) while its mesher hangs: nobody tells the service, and the mesher stays.",
    "A second later it is begun again, which is no attempt; those behind it need not wait. It gives what "
    "Python gives undisturbed, to the last bit, and nothing of the killed one is left.",
)
def _worker_killed_once() -> Sequence[Measured]:
    """Kill the first worker in mid-mesh."""
    outcome, killed = _killing(WORKER_COMMAND, 1, overtaken=True)
    off = np.inf if outcome.errors is None else largest_difference(outcome.errors, python_ste())
    return (
        Measured("workers killed", killed, maximum=1.0, minimum=1.0),
        Measured("done at the first attempt", outcome.ended_as("successful", 1), minimum=1.0),
        Measured("result off that of Python, m", off, maximum=0.0),
        *outcome.figures,
    )


@SCENES.add(
    "worker_killed_at_every_attempt",
    "Every worker of the job crashes while its mesher hangs: tried for ever, it would block all others.",
    f"The job fails at its second attempt, with the signal and the number of attempts; {RECOVERY}",
)
def _worker_killed_always() -> Sequence[Measured]:
    """Let every worker crash in mid-mesh."""
    outcome, killed = _killing(WORKER_COMMAND, 2, as_crash=True)
    message = outcome.job.message
    is_explained = "ended by SIGSEGV" in message and message.endswith("That was attempt 2 of 2.")
    return (
        Measured("workers that crashed", killed, maximum=2.0, minimum=2.0),
        Measured("failed at the last attempt", outcome.ended_as("failed", 2), minimum=1.0),
        Measured("says what ended it, and how often it was tried", is_explained, minimum=1.0),
        *outcome.figures,
    )


def python_ste() -> FloatArray:
    """Return the STE of the medium case, computed in this process, m."""
    case = validated(Case, MEDIUM)
    return analyze(gear_pair(case), table_axes(case), analysis_options(case)).static_transmission_error
