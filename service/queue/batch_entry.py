"""The entry of a batch in the job table: one job and those in it, all or none."""

from __future__ import annotations

import json
import uuid
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from sqlalchemy import Connection, Engine, insert, select

from lineofaction.gearbox.problems import BadInput
from service.project import address_of
from service.queue.batches import FOR_EVER, HELD, batch_steps
from service.queue.cost_limit import extended
from service.queue.differences import NOT_COMPARED, Differences
from service.queue.entry import (
    ended_since,
    enter_computation,
    identifier_of,
    refuse_if_busy,
    refuse_if_full,
    refuse_unless_same,
    shared_computation,
)
from service.queue.tables import computations, jobs
from service.queue.terms import ANYBODY, AS_IT_IS, NO_LABEL, USUAL, Caller, Terms, raised
from service.store import now, retried, writing
from service.version import solver_version


@dataclass(frozen=True)
class BatchCase:
    """One job of a batch before it is entered.

    Attributes
    ----------
    key, inputs
        What to do; its name.
    stored : bool
        Whether the store was seen to have the result.
    cost : float
        What it is predicted to cost beside the others.
    """

    key: str
    inputs: dict[str, Any]
    stored: bool = False
    cost: float = 1.0


class BatchEntry:
    """Enters batches of one caller.

    Parameters
    ----------
    engine : Engine
    queue_limit : int
        Computations that may wait.
    project : str
        In which the batch and its jobs are.
    caller : Caller
    terms : Terms
        The label is that of the batch, the rest holds for its jobs.
    """

    def __init__(
        self, engine: Engine, queue_limit: int, project: str, caller: Caller = ANYBODY, terms: Terms = USUAL
    ) -> None:
        self._engine, self._queue_limit = engine, queue_limit
        self._project, self._caller, self._terms = project, caller, terms

    def submit(self, process: str, cases: Sequence[BatchCase], looked: str, name: str | None = None) -> str:
        """Enter a batch with its jobs, all or none; return its identifier. Equal work is shared.

        Parameters
        ----------
        process : str
        cases : sequence of BatchCase
        looked : str
            When the store was asked for results: work that has ended since is shared too.
        name : str, optional
            The caller's name for this request (``Idempotency-Key``): sent again, it is the same batch.

        Raises
        ------
        BadInput
            The name stands for another batch, or there are more new cases than may ever wait.
        QueueFull
            There is no room for all of them now.
        """
        kind = f"batch of {process}"
        named = None if name is None else identifier_of(self._project, self._caller, kind, name)
        identifier = str(named or uuid.uuid4())
        ours = [replace(case, key=address_of(self._project, case.key)) for case in cases]
        self._submit(identifier, process, ours, looked)
        return identifier

    @retried
    def _submit(self, identifier: str, process: str, cases: Sequence[BatchCase], looked: str) -> None:
        """Enter a batch of this identifier, unless it is in already."""
        with writing(self._engine, in_turn=True) as connection:
            known = select(computations.c.key, computations.c.program).join(jobs)
            entered = connection.execute(
                known.where(jobs.c.parent == identifier).order_by(jobs.c.place)
            ).all()
            if entered:
                if all(row.program == solver_version() for row in entered):
                    keys = " ".join(row.key for row in entered)
                    refuse_unless_same(keys, " ".join(case.key for case in cases))
                return
            shared = {case.key: _shared(connection, case, looked) for case in cases}
            self._refuse_beyond_limits(connection, cases, shared)
            self._enter(connection, identifier, process, cases, shared)
            for step in batch_steps(connection):
                connection.execute(step)

    def _refuse_beyond_limits(
        self, connection: Connection, cases: Sequence[BatchCase], shared: dict[str, str | None]
    ) -> None:
        """Raise if there is no room for the batch, now or ever."""
        waiting = {case.key for case in cases if shared[case.key] is None and not case.stored}
        unfinished = sum(not case.stored for case in cases)
        _refuse_more(len(waiting), self._queue_limit, "new cases: so many may wait (LOA_QUEUE_LIMIT)")
        most = self._caller.unfinished_jobs
        if most is not None:
            _refuse_more(unfinished, most, "unfinished jobs of this key")
        if unfinished:
            refuse_if_busy(connection, self._caller, unfinished)
        if waiting:
            refuse_if_full(connection, self._queue_limit, len(waiting))

    def _enter(
        self,
        connection: Connection,
        identifier: str,
        process: str,
        cases: Sequence[BatchCase],
        shared: dict[str, str | None],
    ) -> None:
        """Enter the batch and its jobs; the first of equal ones bears their cost."""
        common = {"created": now(), "caller": self._caller.name, "delivery": str(AS_IT_IS)}
        common |= {"project": self._project, "differences": str(NOT_COMPARED), **NO_LABEL.columns()}
        rows = [
            _entered_batch(connection, identifier, process, len(cases)) | common | self._terms.label.columns()
        ]
        names, counted = [str(uuid.uuid4()) for _ in cases], set[str]()
        for place, (case, apart) in enumerate(zip(cases, _differences(cases, names), strict=True)):
            computation = shared[case.key]
            if computation is None:
                computation = enter_computation(
                    connection, process, case.key, case.inputs, case.stored, self._terms
                )
                shared[case.key] = computation
            elif case.key not in counted:
                connection.execute(raised(computation, self._terms.priority))
                connection.execute(extended(computation, self._terms.max_cost_s))
            weight = 0.0 if case.stored or case.key in counted else case.cost
            counted.add(case.key)
            row = {"id": names[place], "computation_id": computation, "parent": identifier, "place": place}
            rows.append(common | row | {"children": 0, "weight": weight, "differences": str(apart)})
        connection.execute(insert(jobs), rows)


def _entered_batch(connection: Connection, identifier: str, process: str, children: int) -> dict[str, Any]:
    """Enter what stands for the computation of a batch; return the row of its job."""
    instant, computation = now(), str(uuid.uuid4())
    row = {"id": computation, "process": process, "key": f"batch {identifier}", "inputs": json.dumps({})}
    row |= {"state": "running", "lease": HELD, "message": "", "stage": "jobs"}
    row |= {"created": instant, "started": instant, "updated": instant}
    connection.execute(insert(computations).values(**row, leased_until=FOR_EVER))
    job = {"id": identifier, "computation_id": computation, "parent": None, "place": 0}
    return job | {"children": children, "weight": 0.0}


def _differences(cases: Sequence[BatchCase], names: Sequence[str]) -> Iterator[Differences]:
    """Yield what sets each job of a batch apart from the one before it."""
    yield NOT_COMPARED
    for (before, case), name in zip(pairwise(cases), names, strict=False):
        yield Differences.between(before.inputs, case.inputs, name)


def _shared(connection: Connection, case: BatchCase, looked: str) -> str | None:
    """Return the computation that a case shares, None if there is none yet."""
    return shared_computation(connection, case.key, ended_since(case.key, looked, case.stored))


def _refuse_more(number: int, most: int, of_what: str) -> None:
    """Raise if a batch has more of something than there can ever be room for."""
    if number > most:
        raise BadInput.of("jobs", f"{number} jobs", f"at most {most} {of_what}", "Split the batch.")
