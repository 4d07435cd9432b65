"""A job that cannot end well, with jobs behind it: the ends of all of them."""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from fe_contact.types import FloatArray
from lineofaction.hardcases.jobs.job_service import Disturb, JobService, fresh_service
from lineofaction.hardcases.scene import Measured
from service.queue.job import Job
from service.store.places import DATABASE_FILE

Json = dict[str, Any]
Settle = Callable[[float], Json]
"""Function from the elapsed seconds of the small job, undisturbed, to the settings of the service."""

_SETTLING_S = 2.0
"""Time within which workspaces of ended jobs are removed, s."""

_GEAR = {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0, "thickness_allowance_um": 90.0}


@dataclass(frozen=True)
class Aftermath:
    """The end of a disturbed job, and the figures that were checked after it."""

    job: Job
    """Job after its end."""
    errors: FloatArray | None
    """Transmission errors of the job, if it succeeded at some attempt; else None."""
    figures: tuple[Measured, ...]
    """Figures that every disturbed job must show afterwards."""

    def ended_as(self, status: str, attempts: int) -> bool:
        """Whether the job ended in this status at this attempt."""
        return (self.job.status, self.job.attempts) == (status, attempts)


def aftermath(
    case: Json,
    disturb: Disturb | None = None,
    settle: Settle = lambda _seconds: {},
    *,
    resubmit: bool = False,
    overtaken: bool = False,
) -> Aftermath:
    """Run a job that is disturbed, another that is dismissed behind it, and the small one after both.

    With `resubmit` the first job is submitted once more at the end, undisturbed. `overtaken`: the first job
    waits before its next attempt, so that the others end before it.
    """
    before = undisturbed()
    with fresh_service(**settle(before.seconds)) as service:
        jobs = [service.submit(case), service.submit(_case_of("plane_strain", "draft", (30.0,)))]
        service.submissions.dismiss(jobs[1].id)
        jobs.append(service.submit(SMALL))
        ended = [service.ended(job, disturb if job is jobs[0] else None) for job in jobs]
        figures = (*_left(service), *_others(service, ended, before.errors, overtaken=overtaken))
        last = service.ended(service.submit(case)) if resubmit else ended[0]
        errors = service.errors(last) if last.status == "successful" else None
        service.end_processes()
        return Aftermath(ended[0], errors, figures)


def _case_of(model: str, level: str, torques: tuple[float, ...] = (40.0,), positions: int = 16) -> Json:
    """Return the nominal pair with this model, level, torques in N m and number of positions."""
    return {
        "pair": {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": _GEAR, "wheel": _GEAR},
        "load": {"torque_n_m": list(torques)},
        "accuracy": {"level": level, "positions": positions, "model": model},
    }


SMALL = _case_of("plane_strain", "draft")
"""Small job of a second, of which half is the start of its worker."""
MEDIUM = _case_of("plane_strain", "standard")
"""Job with other meshes than the small one."""
LARGE = _case_of("3d", "fine")
"""Large job of 1.1 GB; the small one needs 270 MB."""
LONG = _case_of("3d", "fine", tuple(float(torque) for torque in range(10, 40)), 1000)
"""Long job, fifty times as long as the small one."""


@dataclass(frozen=True)
class _Undisturbed:
    """The small job in a service that nothing disturbs: elapsed seconds, transmission errors."""

    seconds: float
    errors: FloatArray


@cache
def undisturbed() -> _Undisturbed:
    """Run the small job, once for all scenes of a process."""
    with fresh_service() as service:
        began = time.perf_counter()
        ended = service.ended(service.submit(SMALL))
        return _Undisturbed(time.perf_counter() - began, service.errors(ended))


def _left(service: JobService) -> tuple[Measured, ...]:
    """Return figures on what is left of jobs that have ended, of which there may be nothing."""
    waiting = sum(service.submissions.counts().get(state, 0) for state in ("accepted", "running"))
    with closing(sqlite3.connect(service.directory / DATABASE_FILE)) as table:
        sound = table.execute("PRAGMA integrity_check").fetchone()[0] == "ok"
    failed = sum("exception" in entry or entry["log_level"] == "error" for entry in service.log)
    # a job is reported as ended just before its own workspace is removed
    end = time.monotonic() + _SETTLING_S
    while (left := len(list((service.directory / "work").iterdir()))) and time.monotonic() < end:
        time.sleep(0.05)
    return (
        Measured("processes left", len(service.processes()), maximum=0.0),
        Measured("workspaces left", left, maximum=0.0),
        Measured("jobs that never end", waiting, maximum=0.0),
        Measured("job table sound", sound, minimum=1.0),
        Measured("turns of the scheduler that failed", failed, maximum=0.0),
    )


def _others(
    service: JobService, jobs: list[Job], before: FloatArray, *, overtaken: bool
) -> tuple[Measured, ...]:
    """Return figures on the jobs behind the disturbed one, and on a repetition of the small one."""
    disturbed, dismissed, after = jobs
    as_wished = (dismissed.status, dismissed.attempts, after.status) == ("dismissed", 0, "successful")
    served = disturbed.status != "successful" and service.store.find(disturbed.key, "database") is not None
    # RFC 3339 in UTC: the order of the texts is that of the instants
    in_turn = (str(after.started) < str(disturbed.finished)) == overtaken
    off = largest_difference(service.errors(after), before) if after.status == "successful" else np.inf
    return (
        Measured("results served of a job that failed", served, maximum=0.0),
        Measured("jobs behind it end as they should, in their turn", as_wished and in_turn, minimum=1.0),
        Measured("next job off the same undisturbed, m", off, maximum=0.0),
    )


def largest_difference(first: FloatArray, second: FloatArray) -> float:
    """Return the largest difference of two tables, infinite if they differ in shape."""
    return float(np.max(np.abs(first - second))) if first.shape == second.shape else np.inf
