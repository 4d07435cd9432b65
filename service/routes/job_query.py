"""Parameters by which a list of jobs is filtered (OGC API - Processes 1.0, clause 12.2)."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated, Any, Literal

from fastapi import Depends, Query
from pydantic import Field

from lineofaction.gearbox.problems import BadInput
from service.queue.job_filter import JobFilter
from service.schemas.label import Tag, Title
from service.schemas.ogc import JobStatus

_DURATION: dict[str, Any] = {"ge": 0, "le": 1_000_000_000}


Processes = Annotated[
    list[Annotated[str, Field(pattern="^[A-Za-z0-9_-]{1,64}$")]],
    Query(alias="processID", max_length=32, description="Jobs of these processes"),
]
States = Annotated[list[JobStatus], Query(max_length=16, description="Jobs in these states")]
Types = Annotated[
    list[Literal["process"]],
    Query(alias="type", max_length=4, description="Type of jobs; all jobs are of type process"),
]
Created = Annotated[
    str,
    Query(
        alias="datetime",
        max_length=100,
        description="Jobs created at this instant, or in an interval start/end with .. for an open end",
    ),
]
AtLeast = Annotated[
    int,
    Query(alias="minDuration", description="Jobs that ran for at least this many seconds", **_DURATION),
]
AtMost = Annotated[
    int | None,
    Query(alias="maxDuration", description="Jobs that ran for at most this many seconds", **_DURATION),
]
Tags = Annotated[list[Tag], Query(max_length=16, description="Jobs that have all of these tags")]
Words = Annotated[Title, Query(description="Jobs with all of these words in their title, in any case")]
Parent = Annotated[
    str | None,
    Query(pattern="^[0-9a-f-]{36}$", description="Jobs of this batch; without it, batches and jobs of none"),
]


def job_filter(
    process_id: Processes = [],  # noqa: B006 (the framework copies it)
    status: States = [],  # noqa: B006
    kind: Types = [],  # noqa: B006
    instant: Created = "../..",
    shortest: AtLeast = 0,
    longest: AtMost = None,
    tag: Tags = [],  # noqa: B006
    title: Words = "",
    parent: Parent = None,
) -> JobFilter:
    """Return what the parameters ask for."""
    earliest, latest = _interval(instant)
    return JobFilter(
        tuple(process_id),
        tuple(status),
        earliest,
        latest,
        float(shortest) if shortest else None,
        longest,
        tuple(tag),
        tuple(title.split()),
        parent=parent,
    )


JobQuery = Annotated[JobFilter, Depends(job_filter)]


def _interval(text: str) -> tuple[str | None, str | None]:
    """Return both ends of an interval; of an instant, twice the same."""
    parts = text.split("/")
    try:
        if len(parts) > 2 or parts == [".."]:
            raise ValueError(text)
        ends = [None if part in ("", "..") and len(parts) == 2 else _instant(part) for part in parts]
    except (ValueError, OverflowError):
        bound = "an RFC 3339 instant such as 2026-01-31T12:00:00Z, or start/end with .. for an open end"
        raise BadInput.of("datetime", text, bound, "Give the time zone, Z for UTC.") from None
    return ends[0], ends[-1]


def _instant(text: str) -> str:
    """Return an instant as it is stored."""
    instant = datetime.fromisoformat(text)
    if instant.tzinfo is None:
        raise ValueError(text)
    return instant.astimezone(UTC).isoformat(timespec="microseconds").replace("+00:00", "Z")
