"""The job before the next: what the inputs of a new job are compared with."""

from __future__ import annotations

import json
from typing import Any

from sqlalchemy import Engine, Select, bindparam, select

from service.queue.tables import computations, jobs
from service.queue.terms import Caller
from service.store import reading, retried

_LOOKED_AT = 200
"""Jobs of a caller, the newest first, among which one of the process is sought."""


def _newest() -> Select[Any]:
    """Return the statement for the newest job of a caller and a process."""
    recent = (
        select(jobs.c.id, jobs.c.created, jobs.c.computation_id)
        .where(jobs.c.caller == bindparam("caller"), jobs.c.project == bindparam("project"))
        .where(jobs.c.children == 0)
        .order_by(jobs.c.created.desc(), jobs.c.id.desc())
        .limit(_LOOKED_AT)
        .subquery()
    )
    return (
        select(recent.c.id, computations.c.inputs)
        .join(computations, recent.c.computation_id == computations.c.id)
        .where(computations.c.process == bindparam("process"))
        .order_by(recent.c.created.desc(), recent.c.id.desc())
        .limit(1)
    )


_NEWEST = _newest()  # made once: composing it takes longer than running it


class FormerJobs:
    """The newest jobs of the callers of a project.

    Parameters
    ----------
    engine : Engine
    project : str
    """

    def __init__(self, engine: Engine, project: str) -> None:
        self._engine, self._project = engine, project

    @retried
    def newest(self, caller: Caller, process: str) -> tuple[str, dict[str, Any]] | None:
        """Return identifier and normalized inputs of the caller's newest job of a process, None without one.

        Jobs before the caller's last 200 are not looked at.
        """
        sought = {"caller": caller.name, "project": self._project, "process": process}
        with reading(self._engine) as connection:
            row = connection.execute(_NEWEST, sought).one_or_none()
        return None if row is None else (row.id, json.loads(row.inputs))
