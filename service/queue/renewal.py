"""Waiting work of another version of the program: validated again, renamed, or ended with field and reason.

The key of a result contains the version of the program. So work that waits over an upgrade gets the key of
this version; its job keeps its identifier.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import structlog
from sqlalchemy import Connection, delete, select, update

from lineofaction.gearbox.problems import BadInput, DatabaseUnavailable, ServiceError, StoreUnavailable
from lineofaction.gearbox.schemas.reading import validated
from service.project import address_of
from service.queue.batch_progress import end_computations
from service.queue.claims import Claim, Claims
from service.queue.entry import LIVE, widen_terms
from service.queue.tables import computations, jobs
from service.store.database import now, writing
from service.store.results import ResultStore
from service.store.retries import retried
from service.worker.process import Process, Registry

Json = dict[str, Any]
logger = structlog.get_logger(__name__)


class Renewal:
    """Takes over waiting computations of other versions for this program, and removes their files."""

    def __init__(self, claims: Claims, registry: Registry, store: ResultStore, work: Path) -> None:
        self._claims, self._engine = claims, claims.engine
        self._registry, self._store, self._work = registry, store, work

    def renew(self, claim: Claim) -> None:
        """Give waiting work the key of this version; end it if its inputs are refused or no process fits."""
        former = f"Version {claim.program or '0.2.0 or older'} entered the job"
        shutil.rmtree(self._work / claim.id, ignore_errors=True)  # blocks of another solver
        try:
            process = self._registry[claim.process]
            inputs = self._inputs(process, claim)
            key = process.key(inputs)
            stored = self._store.within(claim.project).find(key, process.kind) is not None
        except (DatabaseUnavailable, StoreUnavailable):
            raise  # it is renewed when they are back
        except ServiceError as error:
            text = f"{former}; {self._claims.program} refuses it: {error}"
            self._end(claim, text, json.dumps([fault.as_json() for fault in error.faults]))
        except Exception:
            logger.exception("work of another version", computation=claim.id)
            self._end(claim, f"{former}; {self._claims.program} cannot read it. Submit it again.")
        else:
            self._take(claim, replace(claim, key=key, inputs=inputs), stored=stored)

    def _inputs(self, process: Process, claim: Claim) -> Json:
        """Return the inputs as this version normalizes them.

        If the former normalized inputs are refused, for example for a field that is gone, the caller's are
        used, which name fewer fields. Raises the refusal of the last that was tried.
        """
        refusal: ServiceError | None = None
        for inputs in (claim.inputs, *self._specified_inputs(claim)):
            try:
                store = self._store.within(claim.project)
                return process.prepare(validated(process.inputs, inputs), store)
            except BadInput as error:
                refusal = error
        assert refusal is not None
        raise refusal

    def _specified_inputs(self, claim: Claim) -> Iterator[Json]:
        """Yield the inputs as callers stated them, where they were kept."""
        for text in self._texts(claim):
            yield json.loads(text)

    @retried
    def _texts(self, claim: Claim) -> list[str]:
        conditions = (jobs.c.computation_id == claim.id, jobs.c.stated != "", jobs.c.dismissed.is_(None))
        with writing(self._engine) as connection:
            rows = connection.execute(
                select(jobs.c.stated).where(*conditions).order_by(jobs.c.created).limit(1)
            )
            return list(rows.scalars())

    @retried
    def _take(self, former: Claim, claim: Claim, *, stored: bool) -> None:
        """Give waiting work its new key; a stored result ends it, and equal live work takes over its jobs."""
        address = address_of(claim.project, claim.key)
        waits = (computations.c.id == claim.id) & (computations.c.state == "accepted")
        values: Json = {"key": address, "inputs": json.dumps(claim.inputs), "program": self._claims.program}
        if stored:
            values |= {"state": "successful", "message": "Taken from the store.", "fraction": 1.0}
            values |= {"started": now(), "finished": now(), "updated": now()}
        with writing(self._engine, in_turn=True) as connection:
            row = connection.execute(select(computations).where(waits)).one_or_none()
            if row is None:
                return
            equal = (computations.c.key == address) & computations.c.state.in_(LIVE)
            others = select(computations.c.id).where(equal, computations.c.id != claim.id)
            equal_id = connection.execute(others).scalar()
            if equal_id is None or stored:
                connection.execute(update(computations).where(waits).values(**values))
            else:
                widen_terms(connection, equal_id, row.priority, row.max_cost_s)
                _join(connection, claim.id, equal_id)
        fields = {"computation": claim.id, "former": former.key, "key": claim.key, "program": former.program}
        logger.info("work renewed", **fields)

    @retried
    def _end(self, claim: Claim, text: str, faults: str = "[]") -> None:
        waits = (computations.c.id == claim.id) & (computations.c.state == "accepted")
        values = {"state": "failed", "message": text.replace("\0", ""), "faults": faults}
        with writing(self._engine) as connection:
            end_computations(connection, waits, values)


def _join(connection: Connection, computation: str, other: str) -> None:
    """Move the jobs of a computation to another, which does the same work, and delete it."""
    conditions = jobs.c.computation_id == computation
    connection.execute(update(jobs).where(conditions).values(computation_id=other))
    connection.execute(delete(computations).where(computations.c.id == computation))
