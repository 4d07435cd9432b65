"""A job as its caller sees it, the text of its subject, and the filter of a list of jobs."""

from __future__ import annotations

import json
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache
from typing import Any

from sqlalchemy import ColumnElement, case, func, or_, select

from bounds import engineering
from service.project import at_address
from service.queue.differences import differences_of
from service.queue.tables import BATCH, computations, jobs, of_batch
from service.queue.terms import Delivery, Label
from service.schemas.answers import Differences
from service.store.results import results

Json = dict[str, Any]
ENDED = ("successful", "failed", "dismissed")
"""States in which nothing more happens."""
LEAST_LEFT = 0.5
"""Part of what was left at the last report below which it does not fall without another."""
_PACE_KNOWN = 0.02  # share of the work after which the pace is known
_AS_STORED = (
    *("process", "stage", "stage_fraction", "fraction", "attempts", "started", "reference", "inputs"),
    *("priority", "max_cost_s", "caller", "parent", "place", "children"),
)
"""Fields of a job that are columns of its row."""
_JOB_COLUMNS = (  # of the table of jobs; the others are those of computations
    *("dismissed", "asked", "delivery", "title", "tags", "differences", "stated"),
    *("caller", "parent", "place", "children"),
)


@lru_cache(maxsize=1024)
def subject_of(inputs: str) -> str:
    """Return a short text on normalized inputs, JSON: the pair with its highest load, the scene, or none."""
    document = json.loads(inputs)
    if document.get("scene") is not None:
        meshes = len(document["scene"]["meshes"])
        return f"scene of {meshes} mesh{'' if meshes == 1 else 'es'}"
    return "" if document.get("case") is None else _pair(document["case"])


def _pair(case: Json) -> str:
    pair, load = case["pair"], case["load"]
    teeth = "/".join(str(pair[gear]["teeth"]) for gear in ("pinion", "wheel"))
    torques = load.get("torque_n_m") or ()
    up_to = f", up to {engineering(max(torques), 4)} N m" if torques else ""
    return f"{teeth}, module {engineering(pair['normal_module_mm'], 4)} mm{up_to}"


@dataclass(frozen=True)
class Job:
    """A job with the state of its computation; times are RFC 3339 in UTC, inputs JSON.

    `inputs` are normalized, as they are computed; `stated` are the caller's, or the normalized ones where
    those were not kept. A batch has so many `children`: each has the batch as `parent`, and its index from 0
    as `place`. While a job waits, `ahead` computations of all projects run or have an earlier turn; None: it
    does not wait, or is a batch. `headline` is what a list shows of the result; None: no result, or one of an
    older version.
    """

    id: str
    computation: str
    process: str
    key: str
    status: str
    message: str
    stage: str
    stage_fraction: float
    fraction: float
    attempts: int
    created: str
    started: str | None
    finished: str | None
    updated: str
    faults: tuple[dict[str, Any], ...]
    reference: str
    delivery: Delivery
    inputs: str
    stated: str
    label: Label
    differences: Differences
    priority: int
    max_cost_s: float | None
    caller: str
    parent: str | None = None
    place: int = 0
    children: int = 0
    ahead: int | None = None
    headline: Json | None = None

    @property
    def ended(self) -> bool:
        """Whether the job has ended."""
        return self.status in ENDED

    @property
    def mark(self) -> str:
        """A text that differs between any two states that a follower is told of."""
        return mark_of(self.updated, self.ahead)

    def remaining_s(self, instant: datetime) -> float | None:
        """Return the seconds that a running job still needs at an instant, at the pace of its last report.

        None where the pace is not known: before `_PACE_KNOWN` of the work, and in a repeated attempt.
        """
        if self.status != "running" or self.started is None or self.attempts > 1:
            return None
        if not _PACE_KNOWN <= self.fraction < 1.0:
            return None
        updated = datetime.fromisoformat(self.updated)
        spent = (updated - datetime.fromisoformat(self.started)).total_seconds()
        seconds = spent * (1.0 - self.fraction) / self.fraction
        return max(seconds - (instant - updated).total_seconds(), LEAST_LEFT * seconds)


def mark_of(updated: str, ahead: int | None) -> str:
    """Return the mark of a job's state: when it changed last, and while it waits behind how many."""
    return updated if ahead is None else f"{updated}/{ahead}"


def _ahead() -> ColumnElement[Any]:
    """Return the number of computations before one that waits, in the order of `Claims.claim`."""
    waiting, other = computations.c, computations.alias().c
    earlier = (other.priority > waiting.priority) | (other.created < waiting.created)
    before = (other.state == "accepted") & (other.priority >= waiting.priority) & earlier
    number = select(func.count()).where(or_(other.state == "running", before), ~other.key.startswith(BATCH))
    return case(((waiting.state == "accepted") & ~of_batch, number.scalar_subquery()))


AHEAD = _ahead()
"""The column `Job.ahead` of a selection of computations, composed once."""


def job_state() -> ColumnElement[Any]:
    """Return a job's state: a caller who dismissed sees "dismissed", also if the shared work goes on."""
    return case((jobs.c.dismissed.is_not(None), "dismissed"), else_=computations.c.state)


def jobs_of_all_projects() -> Any:
    """Select jobs with their computations; callers see jobs of their project alone."""
    of_computation = (results.c.key == computations.c.key) & (results.c.headline != "")
    return select(
        jobs.c.id.label("job_id"),
        jobs.c.created.label("job_created"),
        *(jobs.c[name] for name in _JOB_COLUMNS),
        computations,
        AHEAD.label("ahead"),
        results.c.headline,
    ).select_from(jobs.join(computations).outerjoin(results, of_computation))


def job_of(row: Any) -> Job:
    """Return a row as a job; its state is that of `job_state`."""
    dismissed = row.dismissed is not None
    return Job(
        **{name: getattr(row, name) for name in _AS_STORED},
        id=row.job_id,
        computation=row.id,
        key=at_address(row.key)[1],  # the row has project and key in one text
        status="dismissed" if dismissed else row.state,
        message="Cancelled." if dismissed else row.message,
        created=row.job_created,
        finished=row.dismissed or row.finished,
        updated=row.dismissed or row.updated,
        faults=tuple(json.loads(row.faults)),
        delivery=Delivery.of(row.delivery),
        stated=row.stated or row.inputs,
        label=Label.from_row(row),
        differences=differences_of(row.differences),
        ahead=None if dismissed else row.ahead,
        headline=None if row.headline is None else json.loads(row.headline) or None,
    )


@dataclass(frozen=True)
class JobFilter:
    """Conditions that a job has to meet.

    `earliest` and `latest` are instants of creation, RFC 3339 in UTC with microseconds.
    """

    processes: tuple[str, ...] = ()
    statuses: tuple[str, ...] = ()
    """`processes`, `statuses`: The job has one of them; empty: any."""
    earliest: str | None = None
    latest: str | None = None
    shortest_s: float | None = None
    longest_s: float | None = None
    """`shortest_s`, `longest_s`: Bounds of the run time; jobs that have not begun are left out."""
    tags: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    """`tags`, `words`: The job has all of these tags, and all words in its title, in any case."""
    parent: str | None = None
    """Batch of the job; None: batches, and jobs outside batches."""
    once: bool = False
    """Whether one job is listed for each result: the newest, and none that failed unless all did."""

    @property
    def asks_duration(self) -> bool:
        """Whether the time run is bounded."""
        return self.shortest_s is not None or self.longest_s is not None


EVERY_JOB = JobFilter()
