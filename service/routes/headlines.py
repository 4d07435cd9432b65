"""Headlines of results that an older version stored without headlines, computed when their jobs are shown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import structlog

from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import DatabaseUnavailable, StoreUnavailable
from service.queue.job import Job
from service.routes.context import Context
from service.worker.process import ANALYZE

logger = structlog.get_logger(__name__)
headline_json = on_demand("lineofaction.gearbox.convert.answers:headline_json")

MAX_AT_ONCE = 4
"""Most tables that one list reads; the next list continues."""
LARGEST_BYTES = 8_000_000
"""Most bytes of a table that is read for a headline: tables of long periods take seconds."""


def with_headlines(jobs: Sequence[Job], context: Context) -> list[Job]:
    """Return jobs with the headlines of their tables; a few missing ones are computed and stored."""
    lacking = {job.key for job in jobs if job.process == ANALYZE.id and _ended_without(job)}
    lines = context.store.without_headline(lacking, ANALYZE.kind, MAX_AT_ONCE) if lacking else []
    headlines = {line.key: _headline_of(line.key, line.size, context) for line in lines}
    return [replace(job, headline=headlines.get(job.key) or job.headline) for job in jobs]


def _ended_without(job: Job) -> bool:
    return job.status == "successful" and job.headline is None


def _headline_of(key: str, size: int, context: Context) -> dict[str, Any]:
    """Compute and store the headline of a table; an empty one, too, so that no table is read twice."""
    headline: dict[str, Any] = {}
    try:
        if size <= LARGEST_BYTES:
            headline = headline_json(context.databases.get(context.store, key).database)
    except (DatabaseUnavailable, StoreUnavailable):
        return headline
    except Exception as error:  # noqa: BLE001 (a list is shown whatever is wrong with an old file)
        logger.warning("no headline", key=key, error=str(error))
    context.store.note_headline(key, ANALYZE.kind, headline)
    return headline
