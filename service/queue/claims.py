"""The scheduler's side of the job table: claim, progress, end, put back.

A computation waits (state "accepted"), runs or has ended. The scheduler claims a waiting one to run it.
One server owns the table (`service.store.ownership.Ownership`), but callers may dismiss a computation at any
time. So each statement changes a computation only while its state is "running", and a dismissed one stays
dismissed. A lost run is one whose end was not recorded, because the server ended first.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy import ColumnElement, Engine, Row, or_, select, update

from service.project import COMMON, at_address
from service.queue.batch_progress import batch_steps, end_computations
from service.queue.tables import computations, of_batch
from service.store.database import instant, now, reading, writing
from service.store.retries import retried
from service.version import solver_version

MAX_LOST_RUNS = 10
"""Number of consecutive lost runs at which a computation fails, as the probable cause of the losses."""
SUSPECT_FROM = 3
"""Number of consecutive lost runs from which a computation runs alone.

The computation that ends the server is found in this way.
"""
_LONGEST_WAIT_S = 60.0
"""Longest wait of a computation after lost runs, s."""


def wait_s(lost_runs: int) -> float:
    """Return the wait of a computation before its next run, s: 1 s after a lost run, doubled by each next."""
    return float(min(2.0 ** (lost_runs - 1), _LONGEST_WAIT_S)) if lost_runs else 0.0


@dataclass(frozen=True)
class Claim:
    """A computation that the scheduler runs."""

    id: str
    process: str
    """Name of the process, which is a kind of computation."""
    key: str
    """Content hash of the inputs, under which the result is stored."""
    inputs: dict[str, Any]
    attempts: int
    """Number of runs that count against the limit, this one included."""
    max_cost_s: float | None = None
    """Limit of the cost, CPU s, at the time of the claim; None: no limit."""
    traceparent: str = field(default="", compare=False)
    """Trace of the request; empty: none."""
    waited_from: str = field(default="", compare=False)
    """Time (RFC 3339) at which it was entered or put back."""
    project: str = COMMON
    program: str = field(default="", compare=False)
    """Version of the service that entered it."""
    lost_runs: int = field(default=0, compare=False)
    """Number of consecutive lost runs before this one."""

    @property
    def suspect(self) -> bool:
        """Whether the computation must run alone."""
        return self.lost_runs >= SUSPECT_FROM


@dataclass(frozen=True)
class Reached:
    """Progress of work: stage, completed fraction of the stage, and of the whole if it is known."""

    stage: str
    stage_fraction: float
    fraction: float | None

    def columns(self) -> dict[str, Any]:
        """Return the progress as columns of the job table."""
        fraction = {} if self.fraction is None else {"fraction": self.fraction}
        stage = {"stage": self.stage, "stage_fraction": self.stage_fraction}
        return stage | fraction | {"message": f"Runs: {self.stage}."}


class Claims:
    """Computations as the scheduler of a version of this program sees them."""

    def __init__(self, engine: Engine, program: str = solver_version()) -> None:
        self.engine = self._engine = engine
        self.program = program

    def claim(self, *, alongside: bool = False) -> Claim | None:
        """Claim the oldest waiting computation of the highest priority; None: none may run now.

        A computation that another version entered is returned but not claimed: `service.queue.renewal` enters
        it anew. `alongside`: other computations run. A suspect is then not claimed, nor one behind it.
        """
        while (row := self._first()) is not None:
            claim = _claim_of(row)
            if row.program != self.program:
                return claim
            if alongside and claim.suspect:
                return None
            if self._begin(row):
                return replace(claim, attempts=row.attempts + 1, waited_from=row.updated)
        return None

    @retried
    def _first(self) -> Row[Any] | None:
        waiting = select(computations).where(computations.c.state == "accepted", _waited_long_enough())
        turn = (computations.c.priority.desc(), computations.c.created)
        with reading(self._engine) as connection:
            return connection.execute(waiting.order_by(*turn).limit(1)).one_or_none()

    @retried
    def _begin(self, row: Row[Any]) -> bool:
        """Set a waiting computation to running; return False if it was dismissed."""
        attempt, table = row.attempts + 1, computations.c
        # a repetition, after a lost connection, finds the computation running in this attempt
        waits = (table.state == "accepted") | (table.state == "running") & (table.attempts == attempt)
        values = {"attempts": attempt, "started": row.started or now(), "state": "running"}
        values |= {"message": "Starts.", "updated": now()}
        with writing(self._engine) as connection:
            change = update(computations).where(table.id == row.id, waits).values(**values)
            return connection.execute(change).rowcount > 0

    def note_runs(self, claims: Collection[Claim]) -> None:
        """Count runs that have begun as lost runs, until their end is recorded."""
        self._change([(claim, {"lost_runs": claim.lost_runs + 1}) for claim in claims])

    @retried
    def still_running(self, claims: Collection[Claim]) -> set[str]:
        """Return the ids of the computations that still run, so were not dismissed."""
        if not claims:
            return set()
        which = _running(claims)
        with reading(self._engine) as connection:
            return set(connection.execute(select(computations.c.id).where(which)).scalars())

    @retried
    def max_cost_s(self, claim: Claim) -> float | None:
        """Return the CPU seconds that a computation may take now; None: no limit."""
        statement = select(computations.c.max_cost_s).where(computations.c.id == claim.id)
        with reading(self._engine) as connection:
            limit: float | None = connection.execute(statement).scalar()
            return limit

    def progress(self, reached: Sequence[tuple[Claim, Reached]]) -> None:
        """Record the progress of computations in one transaction."""
        self._change([(claim, point.columns()) for claim, point in reached])

    def succeed(self, claim: Claim) -> None:
        """End a computation whose result is stored."""
        done = {"state": "successful", "message": "Done.", "fraction": 1.0, "stage_fraction": 1.0}
        self._end_with(claim, done)

    def fail(
        self, claim: Claim, message: str, faults: Sequence[dict[str, Any]] = (), reference: str = ""
    ) -> None:
        """End a computation without a result."""
        details = {"faults": json.dumps(list(faults)), "reference": reference}
        self._end_with(claim, {"state": "failed", "message": message.replace("\0", "")} | details)

    def put_back(self, claim: Claim, message: str, *, counted: bool, lost_runs: int | None = None) -> None:
        """Let a computation wait again.

        `counted`: the run counts among the attempts, and there are no consecutive lost runs. A run that ended
        for no fault of the computation is not counted; `lost_runs` is then the number of consecutive lost
        runs, None: as before the run.
        """
        attempts = claim.attempts if counted else claim.attempts - 1
        lost_runs = claim.lost_runs if lost_runs is None else lost_runs
        values = {"state": "accepted", "message": message, "stage": "", "stage_fraction": 0.0}
        values |= {"fraction": 0.0, "attempts": attempts, "lost_runs": 0 if counted else lost_runs}
        if attempts == 0:
            values["started"] = None
        self._change([(claim, values)])

    @retried
    def _end_with(self, claim: Claim, values: dict[str, Any]) -> None:
        with writing(self._engine) as connection:
            end_computations(connection, _running([claim]), values)

    @retried
    def _change(self, changes: Sequence[tuple[Claim, dict[str, Any]]]) -> None:
        with writing(self._engine) as connection:
            for claim, values in changes:
                changed = update(computations).where(_running([claim])).values(updated=now(), **values)
                connection.execute(changed)

    @retried
    def advance_batches(self) -> None:
        """Record the progress of batches, which follows from the states of their jobs."""
        with reading(self._engine) as connection:
            steps = batch_steps(connection)
        if not steps:
            return
        with writing(self._engine) as connection:
            for step in steps:
                connection.execute(step)

    @retried
    def running(self) -> list[Claim]:
        """Return the running computations; when a server starts, they are those of a former one that died."""
        runs = (computations.c.state == "running") & ~of_batch
        with reading(self._engine) as connection:
            return [_claim_of(row) for row in connection.execute(select(computations).where(runs))]

    @retried
    def waiting(self) -> set[str]:
        """Return the ids of the computations that wait."""
        statement = select(computations.c.id).where(computations.c.state == "accepted")
        with reading(self._engine) as connection:
            return set(connection.execute(statement).scalars())


def _running(claims: Collection[Claim]) -> ColumnElement[bool]:
    """Return the condition that a row is one of the claims and runs."""
    return computations.c.id.in_([claim.id for claim in claims]) & (computations.c.state == "running")


def _waited_long_enough() -> ColumnElement[bool]:
    """Return the condition that a computation has waited `wait_s` since its last lost run."""
    table, time = computations.c, datetime.now(UTC)
    due = [
        (table.lost_runs == lost) & (table.updated <= instant(time - timedelta(seconds=wait_s(lost))))
        for lost in range(1, MAX_LOST_RUNS)
    ]
    return or_(table.lost_runs == 0, *due, table.lost_runs >= MAX_LOST_RUNS)


def _claim_of(row: Row[Any]) -> Claim:
    project, key = at_address(row.key)
    return Claim(
        id=row.id,
        process=row.process,
        key=key,
        inputs=json.loads(row.inputs),
        attempts=row.attempts,
        max_cost_s=row.max_cost_s,
        traceparent=row.traceparent,
        project=project,
        program=row.program,
        lost_runs=row.lost_runs,
    )
