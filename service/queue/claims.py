"""The scheduler's side of the job table: claim, progress, end, put back.

One server owns the table (`service.store.ownership.Ownership`); callers dismiss meanwhile. So each step names
its computation as one that runs: one that was dismissed stays so.
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
"""Most lost runs of a computation in a row. A computation that reaches it is taken for the cause of the
losses and fails."""
SUSPECT_FROM = 3
"""Number of lost runs in a row from which a computation runs alone. So the computation that ends the server
is found."""
_LONGEST_WAIT_S = 60.0


def wait_s(lost_runs: int) -> float:
    """Return the wait of a computation after lost runs in a row, s: 1 s, twice as long each time."""
    return float(min(2.0 ** (lost_runs - 1), _LONGEST_WAIT_S)) if lost_runs else 0.0


@dataclass(frozen=True)
class Claim:
    """A computation that runs; `attempts` counts this one.

    `max_cost_s` (CPU s; None: no limit) is what was known when it was claimed, `waited_from` when it was
    entered or put back (RFC 3339), `program` the version that entered it. An empty `traceparent` belongs to
    no trace. `lost_runs` are those in a row that began and whose end nobody saw, as the server ended.
    """

    id: str
    process: str
    key: str
    inputs: dict[str, Any]
    attempts: int
    max_cost_s: float | None = None
    traceparent: str = field(default="", compare=False)
    waited_from: str = field(default="", compare=False)
    project: str = COMMON
    program: str = field(default="", compare=False)
    lost_runs: int = field(default=0, compare=False)

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
        """Return it as the job table has it."""
        fraction = {} if self.fraction is None else {"fraction": self.fraction}
        at = {"stage": self.stage, "stage_fraction": self.stage_fraction}
        return at | fraction | {"message": f"Runs: {self.stage}."}


class Claims:
    """Computations as the scheduler of a version of this program sees them."""

    def __init__(self, engine: Engine, program: str = solver_version()) -> None:
        self.engine = self._engine = engine
        self.program = program

    def claim(self, *, alongside: bool = False) -> Claim | None:
        """Take the oldest waiting computation of the highest priority; None: none is to run now.

        What another version entered is returned as it waits, for `service.queue.renewal`. A suspect is not
        taken `alongside` other computations, and nothing is taken before it.
        """
        while (row := self._first()) is not None:
            claim = _claimed(row)
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
        """Let a waiting computation run, unless it was dismissed; a repeated step finds it running."""
        attempt, table = row.attempts + 1, computations.c
        waits = (table.state == "accepted") | (table.state == "running") & (table.attempts == attempt)
        values = {"attempts": attempt, "started": row.started or now(), "state": "running"}
        values |= {"message": "Starts.", "updated": now()}
        with writing(self._engine) as connection:
            change = update(computations).where(table.id == row.id, waits).values(**values)
            return connection.execute(change).rowcount > 0

    def note_runs(self, claims: Collection[Claim]) -> None:
        """Count runs that have begun as lost: they are, unless their end is noted."""
        self._change([(claim, {"lost_runs": claim.lost_runs + 1}) for claim in claims])

    @retried
    def still_running(self, claims: Collection[Claim]) -> set[str]:
        """Return the computations that still run: that were not dismissed."""
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
        """Note how far works are, in one transaction."""
        self._change([(claim, point.columns()) for claim, point in reached])

    def succeed(self, claim: Claim) -> None:
        """End with the result stored."""
        done = {"state": "successful", "message": "Done.", "fraction": 1.0, "stage_fraction": 1.0}
        self._end_with(claim, done)

    def fail(
        self, claim: Claim, message: str, faults: Sequence[dict[str, Any]] = (), reference: str = ""
    ) -> None:
        """End without a result."""
        details = {"faults": json.dumps(list(faults)), "reference": reference}
        self._end_with(claim, {"state": "failed", "message": message.replace("\0", "")} | details)

    def put_back(self, claim: Claim, message: str, *, counted: bool, lost_runs: int | None = None) -> None:
        """Let it wait again; an attempt that ended through no fault of its own is not counted.

        It has then so many `lost_runs` in a row, None: those that it had, and none after one that counts.
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
        """Note how far batches are by the states of their jobs."""
        with reading(self._engine) as connection:
            steps = batch_steps(connection)
        if not steps:
            return
        with writing(self._engine) as connection:
            for step in steps:
                connection.execute(step)

    @retried
    def running(self) -> list[Claim]:
        """Return the running computations of the table; at a start those of a server that died."""
        runs = (computations.c.state == "running") & ~of_batch
        with reading(self._engine) as connection:
            return [_claimed(row) for row in connection.execute(select(computations).where(runs))]

    @retried
    def waiting(self) -> set[str]:
        """Return the computations that wait."""
        statement = select(computations.c.id).where(computations.c.state == "accepted")
        with reading(self._engine) as connection:
            return set(connection.execute(statement).scalars())


def _running(claims: Collection[Claim]) -> ColumnElement[bool]:
    """Return the condition of claimed computations that run."""
    return computations.c.id.in_([claim.id for claim in claims]) & (computations.c.state == "running")


def _waited_long_enough() -> ColumnElement[bool]:
    """Return the condition of computations that have waited long enough since their lost runs."""
    table, time = computations.c, datetime.now(UTC)
    due = [
        (table.lost_runs == lost) & (table.updated <= instant(time - timedelta(seconds=wait_s(lost))))
        for lost in range(1, MAX_LOST_RUNS)
    ]
    return or_(table.lost_runs == 0, *due, table.lost_runs >= MAX_LOST_RUNS)


def _claimed(row: Row[Any]) -> Claim:
    inputs, (project, key) = json.loads(row.inputs), at_address(row.key)
    fields = (row.id, row.process, key, inputs, row.attempts, row.max_cost_s, row.traceparent)
    return Claim(*fields, project=project, program=row.program, lost_runs=row.lost_runs)
