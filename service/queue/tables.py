"""Tables of jobs: a job is one caller's request, a computation is the work that several jobs may share."""

from __future__ import annotations

from sqlalchemy import BigInteger, Column, Float, ForeignKey, Index, Integer, String, Table, Text, text

from service.store.database import metadata
from service.version import solver_version

_LIVE = text("state IN ('accepted', 'running')")

computations = Table(
    "computation",
    metadata,
    Column("id", String, primary_key=True),
    Column("process", String, nullable=False),
    Column("key", String, nullable=False),
    Column("inputs", Text, nullable=False),
    Column("state", String, nullable=False),
    Column("stage", String, nullable=False, default=""),
    Column("stage_fraction", Float, nullable=False, default=0.0),
    Column("fraction", Float, nullable=False, default=0.0),
    Column("message", Text, nullable=False, default=""),
    Column("faults", Text, nullable=False, default="[]"),
    Column("reference", String, nullable=False, default=""),
    Column("attempts", Integer, nullable=False, default=0),
    Column("created", String, nullable=False),
    Column("started", String),
    Column("finished", String),
    Column("updated", String, nullable=False),
    Column("owner", String, nullable=False, default=""),
    Column("lease", String, nullable=False, default=""),
    Column("leased_until", Float, nullable=False, default=0.0),
    Column("max_cost_s", Float),
    Column("priority", Integer, nullable=False, default=0, server_default="0"),
    Column("traceparent", String, nullable=False, default="", server_default=""),
    Column("program", String, nullable=False, default=solver_version),
)

# Single flight: at most one computation of a key waits or runs. A key is an address: see `service.project`.
Index(
    "computation_in_flight",
    computations.c.key,
    unique=True,
    sqlite_where=_LIVE,
    postgresql_where=_LIVE,
)
Index("computation_by_lease", computations.c.lease)
Index("computation_by_state", computations.c.state, computations.c.created)

Index("computation_by_turn", computations.c.state, computations.c.priority, computations.c.created)

# Counts of ended computations: they outlive the computations, see `service.queue.workload`.
durations = Table(
    "duration",
    metadata,
    Column("process", String, primary_key=True),
    Column("outcome", String, primary_key=True),
    Column("le", String, primary_key=True),
    Column("number", BigInteger, nullable=False),
    Column("seconds", Float, nullable=False),
    Column("attempts", BigInteger, nullable=False),
)

# Calls about jobs to other services, see `service.webhooks`.
webhooks = Table(
    "webhook",
    metadata,
    Column("id", String, primary_key=True),
    Column("job", String, nullable=False),
    Column("event", String, nullable=False),
    Column("uri", Text, nullable=False),
    Column("origin", String, nullable=False),
    Column("state", String, nullable=False, server_default="waiting"),
    Column("attempts", Integer, nullable=False, server_default="0"),
    Column("due", Float, nullable=False, server_default="0"),
    Column("lease", String, nullable=False, server_default=""),
    Column("leased_until", Float, nullable=False, server_default="0"),
    Column("message", Text, nullable=False, server_default=""),
    Column("updated", String, nullable=False),
)
Index("webhook_by_job", webhooks.c.job)
Index("webhook_by_state", webhooks.c.state, webhooks.c.due)
Index("webhook_by_lease", webhooks.c.lease)

jobs = Table(
    "job",
    metadata,
    Column("id", String, primary_key=True),
    Column("computation_id", String, ForeignKey("computation.id"), nullable=False),
    Column("created", String, nullable=False),
    Column("dismissed", String),
    Column("asked", String),
    Column("caller", String, nullable=False, default=""),
    Column("delivery", String, nullable=False),
    Column("title", String, nullable=False, server_default=""),
    Column("title_folded", String, nullable=False, server_default=""),
    Column("tags", Text, nullable=False, server_default=""),
    Column("differences", Text, nullable=False, server_default=""),
    Column("stated", Text, nullable=False, server_default=""),
    Column("project", String, nullable=False, default=""),
    Column("parent", String),
    Column("place", Integer, nullable=False, server_default="0"),
    Column("children", Integer, nullable=False, server_default="0"),
    Column("weight", Float, nullable=False, server_default="0"),
)
Index("job_by_parent", jobs.c.parent)
Index("job_by_caller", jobs.c.caller)
Index("job_by_caller_and_time", jobs.c.caller, jobs.c.created)
Index("job_by_computation", jobs.c.computation_id)
Index("job_by_use", jobs.c.asked)
Index("job_by_time", jobs.c.created)
Index("job_by_project", jobs.c.project, jobs.c.created)
