"""The scheduler's side of the job table: claim, progress, end, put back.

Every step names the state it starts from, so that a computation dismissed meanwhile stays dismissed.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Engine, select, update

from service.jobs.tables import computations
from service.store import now, reading, writing


@dataclass(frozen=True)
class Claim:
    """A computation that is ours to run."""

    id: str
    process: str
    key: str
    inputs: dict[str, Any]
    attempts: int


class Claims:
    """Computations as the scheduler sees them."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def claim(self) -> Claim | None:
        """Take the oldest computation that waits."""
        waiting = select(computations).where(computations.c.state == "accepted")
        with writing(self._engine) as connection:
            row = connection.execute(waiting.order_by(computations.c.created).limit(1)).one_or_none()
            if row is None:
                return None
            values = {"attempts": row.attempts + 1, "started": row.started or now()}
            values |= {"state": "running", "message": "Starts.", "updated": now()}
            connection.execute(update(computations).where(computations.c.id == row.id).values(**values))
        return Claim(row.id, row.process, row.key, json.loads(row.inputs), row.attempts + 1)

    def progress(self, identifier: str, stage: str, stage_fraction: float, fraction: float | None) -> None:
        """Note how far the work is; the fraction of the whole never falls."""
        values: dict[str, Any] = {
            "stage": stage,
            "stage_fraction": stage_fraction,
            "message": f"Runs: {stage}.",
        }
        if fraction is not None:
            values["fraction"] = fraction
        self._from_running(identifier, values)

    def succeed(self, identifier: str) -> None:
        """End with the result stored."""
        done = {"state": "successful", "message": "Done.", "fraction": 1.0, "stage_fraction": 1.0}
        self._from_running(identifier, done | {"finished": now()})

    def fail(
        self, identifier: str, message: str, faults: Sequence[dict[str, Any]] = (), reference: str = ""
    ) -> None:
        """End without a result."""
        facts = {"faults": json.dumps(list(faults)), "reference": reference, "finished": now()}
        self._from_running(identifier, {"state": "failed", "message": message} | facts)

    def put_back(self, identifier: str, message: str, *, counted: bool) -> None:
        """Let it wait again; an attempt that ended through no fault of its own is not counted."""
        values: dict[str, Any] = {"state": "accepted", "message": message, "stage": "", "stage_fraction": 0.0}
        if not counted:
            values["attempts"] = computations.c.attempts - 1
        self._from_running(identifier, values | {"fraction": 0.0})

    def _from_running(self, identifier: str, values: dict[str, Any]) -> None:
        """Change a computation that runs."""
        ours = (computations.c.id == identifier, computations.c.state == "running")
        with writing(self._engine) as connection:
            connection.execute(update(computations).where(*ours).values(updated=now(), **values))

    def running(self) -> list[Claim]:
        """Return what is marked as running: after a start, what a dead service left behind."""
        statement = select(computations).where(computations.c.state == "running")
        with reading(self._engine) as connection:
            rows = connection.execute(statement).all()
        return [Claim(row.id, row.process, row.key, json.loads(row.inputs), row.attempts) for row in rows]

    def waiting(self) -> set[str]:
        """Return the computations that wait."""
        statement = select(computations.c.id).where(computations.c.state == "accepted")
        with reading(self._engine) as connection:
            return set(connection.execute(statement).scalars())

    def dismissed(self, identifiers: Collection[str]) -> set[str]:
        """Return those of `identifiers` that nobody wants any more."""
        if not identifiers:
            return set()
        ours = computations.c.id.in_(list(identifiers))
        statement = select(computations.c.id).where(ours, computations.c.state == "dismissed")
        with reading(self._engine) as connection:
            return set(connection.execute(statement).scalars())
