"""Tables of jobs: a job is one caller's request, a computation is the work that several jobs may share."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from sqlalchemy import BigInteger, Column, Float, ForeignKey, Index, Integer, String, Table, Text, text

from service.store import listing
from service.store.database import metadata
from service.version import solver_version

_LIVE = text("state IN ('accepted', 'running')")
BATCH = "batch "
"""Beginning of the key of a batch in the table of computations. Other keys are hashes, which have no space,
so that no two keys are equal."""
# Columns by which lists are filtered and ordered; triggers of the database update them, see
# `service.store.listing`.
listings = Table("listing", metadata, *listing.columns())


def _columns(kind: Any, *names: str, **options: Any) -> Iterator[Column[Any]]:
    """Yield columns of one type that are never NULL."""
    return (Column(name, kind, nullable=False, **options) for name in names)


computations = Table(
    "computation",
    metadata,
    Column("id", String, primary_key=True),
    *_columns(String, "process", "key", "state", "created", "updated"),
    *_columns(Text, "inputs"),
    *_columns(String, "stage", "reference", default=""),
    *_columns(Float, "stage_fraction", "fraction", default=0.0),
    *_columns(Text, "message", default=""),
    *_columns(Text, "faults", default="[]"),
    *_columns(Integer, "attempts", default=0),
    Column("started", String),
    Column("finished", String),
    Column("max_cost_s", Float),
    *_columns(Integer, "priority", default=0, server_default="0"),
    *_columns(String, "traceparent", default="", server_default=""),
    *_columns(String, "program", default=solver_version),
    *_columns(Integer, "lost_runs", default=0, server_default="0"),
)

# Single flight: at most one computation of a key waits or runs. A key is an address: see `service.project`.
Index("computation_in_flight", computations.c.key, unique=True, sqlite_where=_LIVE, postgresql_where=_LIVE)
Index("computation_by_key", computations.c.key, computations.c.state, computations.c.created)
Index("computation_by_turn", computations.c.state, computations.c.priority, computations.c.created)

# Condition of batches. An index finds the range: "g" is behind all hexadecimal digits. Under the collation of
# a database other keys may lie in it too, which `startswith` excludes.
of_batch = computations.c.key.between(BATCH, f"{BATCH}g") & computations.c.key.startswith(BATCH)

# Counts of ended computations by duration, at most `le` s; they stay when computations are removed, see
# `service.queue.workload`.
durations = Table(
    "duration",
    metadata,
    *(Column(name, String, primary_key=True) for name in ("process", "outcome", "le")),
    *_columns(BigInteger, "number", "attempts"),
    *_columns(Float, "seconds"),
)

# Calls about jobs to other services, see `service.webhooks`.
webhooks = Table(
    "webhook",
    metadata,
    Column("id", String, primary_key=True),
    *_columns(String, "job", "event", "origin", "updated"),
    *_columns(Text, "uri"),
    *_columns(String, "state", server_default="waiting"),
    *_columns(Integer, "attempts", server_default="0"),
    *_columns(Float, "due", "leased_until", server_default="0"),
    *_columns(String, "lease", server_default=""),
    *_columns(Text, "message", server_default=""),
)
Index("webhook_by_job", webhooks.c.job)
Index("webhook_by_state", webhooks.c.state, webhooks.c.due)
Index("webhook_by_lease", webhooks.c.lease)

jobs = Table(
    "job",
    metadata,
    Column("id", String, primary_key=True),
    Column("computation_id", String, ForeignKey("computation.id"), nullable=False),
    *_columns(String, "created", "delivery"),
    *(Column(name, String) for name in ("dismissed", "asked", "parent")),
    *_columns(String, "caller", "project", default=""),
    *_columns(String, "title", "title_folded", server_default=""),
    *_columns(Text, "tags", "differences", "stated", server_default=""),
    *_columns(Integer, "place", "children", server_default="0"),
    *_columns(Float, "weight", server_default="0"),
)
Index("job_by_parent", jobs.c.parent)
Index("job_by_caller_and_time", jobs.c.caller, jobs.c.created)
Index("job_by_computation", jobs.c.computation_id)

for _name, _columns_of in listing.INDEXES.items():
    Index(_name, *(listings.c[column] for column in _columns_of))
