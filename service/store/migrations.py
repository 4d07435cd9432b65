"""Steps from schema to schema of the database, in order.

A step after `USABLE_SINCE` only adds tables, columns and indexes, or removes indexes, which no statement
names. "Earlier" rows are those that were stored before the step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import sqlalchemy as sa

from service.store.listing import add_listing

if TYPE_CHECKING:
    from alembic.operations import Operations

USABLE_SINCE = "0015"
"""Oldest schema whose program can use the newest schema.

A former version of the service, down to this schema, can therefore be started again after an upgrade. A step
that removes or renames a table or a column sets it to the number of this step.
"""

_NAMES = """
UPDATE result SET used = created, file = kind || '/' || substr("key", 1, 2) || '/' || "key"
    || CASE WHEN kind IN ('ablation', 'frontier') THEN '.json' ELSE '.nc' END
"""
"""Statement that fills in the last use and the file name of results stored before the columns."""
_FUNCTION = """
CREATE FUNCTION loa_job_changed() RETURNS trigger LANGUAGE plpgsql
AS $$ BEGIN NOTIFY loa_jobs; RETURN NULL; END $$
"""
"""Function of the triggers by which PostgreSQL notifies servers of changed jobs."""


def migrate(connection: sa.Connection, revision: str | None) -> None:
    """Make the steps after `revision`, or all steps for None, in the transaction of the connection."""
    from alembic.migration import MigrationContext  # noqa: PLC0415 (start-up time: seldom needed)
    from alembic.operations import Operations  # noqa: PLC0415 (start-up time: seldom needed)

    op = Operations(MigrationContext.configure(connection))
    for number, step in STEPS.items():
        if revision is None or number > revision:
            step(op)


def _column(name: str, default: str = "", kind: Any = sa.String) -> sa.Column[Any]:
    return sa.Column(name, kind, nullable=False, server_default=default)


def _columns(kind: Any, *names: str) -> Iterable[sa.Column[Any]]:
    return (sa.Column(name, kind, nullable=False) for name in names)


def _jobs_and_results(op: Operations) -> None:
    _computations(op)
    op.create_table(
        "job",
        sa.Column("id", sa.String, primary_key=True),
        sa.Column("computation_id", sa.String, sa.ForeignKey("computation.id"), nullable=False),
        sa.Column("created", sa.String, nullable=False),
        sa.Column("dismissed", sa.String),
    )
    op.create_index("job_by_computation", "job", ["computation_id"])
    op.create_index("job_by_time", "job", ["created"])
    op.create_table(
        "result",
        sa.Column("key", sa.String, primary_key=True),
        sa.Column("kind", sa.String, primary_key=True),
        sa.Column("sha256", sa.String, nullable=False),
        sa.Column("size", sa.BigInteger, nullable=False),
        sa.Column("created", sa.String, nullable=False),
    )


def _computations(op: Operations) -> None:
    """Add the table of computations, in which at most one row of a key is accepted or running."""
    op.create_table(
        "computation",
        sa.Column("id", sa.String, primary_key=True),
        *_columns(sa.String, "process", "key"),
        sa.Column("inputs", sa.Text, nullable=False),
        *_columns(sa.String, "state", "stage"),
        *_columns(sa.Float, "stage_fraction", "fraction"),
        *_columns(sa.Text, "message", "faults"),
        sa.Column("reference", sa.String, nullable=False),
        sa.Column("attempts", sa.Integer, nullable=False),
        sa.Column("created", sa.String, nullable=False),
        sa.Column("started", sa.String),
        sa.Column("finished", sa.String),
        sa.Column("updated", sa.String, nullable=False),
    )
    live = sa.text("state IN ('accepted', 'running')")
    where: dict[str, Any] = {"sqlite_where": live, "postgresql_where": live}
    op.create_index("computation_in_flight", "computation", ["key"], unique=True, **where)
    op.create_index("computation_by_state", "computation", ["state", "created"])


def _added(table: str, *columns: tuple[Any, ...], **indexes: Sequence[str]) -> Callable[[Operations], None]:
    """Return a step that adds columns and indexes to a table.

    `columns` are tuples of arguments of `_column`; `indexes` are names of indexes with their columns.
    """

    def step(op: Operations) -> None:
        for column in columns:
            op.add_column(table, _column(*column))
        for name, index_columns in indexes.items():
            op.create_index(name, table, index_columns)

    return step


def _uses_of_results(op: Operations) -> None:
    """Add the file name and the last use of results, and the last use of jobs.

    Earlier files are named by kind and key; the last use of an earlier result is its creation.
    """
    op.add_column("result", _column("file"))
    op.add_column("result", _column("used"))
    op.execute(_NAMES)
    op.create_index("result_by_use", "result", ["used"])
    op.add_column("job", sa.Column("asked", sa.String))
    op.create_index("job_by_use", "job", ["asked"])


def _durations(op: Operations) -> None:
    """Add counts of durations by process, outcome and class of duration (`le`, its upper bound)."""
    op.create_table(
        "duration",
        *(sa.Column(name, sa.String, primary_key=True) for name in ("process", "outcome", "le")),
        sa.Column("number", sa.BigInteger, nullable=False),
        sa.Column("seconds", sa.Float, nullable=False),
        sa.Column("attempts", sa.BigInteger, nullable=False),
    )


def _deployments(op: Operations) -> None:
    """Add the name of the deployment, and a mark of the results whose rows were rebuilt from files."""
    op.create_table(
        "deployment",
        sa.Column("id", sa.String, primary_key=True),
        sa.Column("created", sa.String, nullable=False),
        sa.Column("checked", sa.String),
    )
    op.add_column("result", sa.Column("reindexed", sa.String))


def _terms_of_jobs(op: Operations) -> None:
    """Add title, tags, differences, priority and the limit of cost of a job; earlier jobs have none."""
    for name in ("title", "title_folded"):
        op.add_column("job", _column(name))
    for name in ("tags", "differences"):
        op.add_column("job", _column(name, kind=sa.Text))
    op.create_index("job_by_caller_and_time", "job", ["caller", "created"])
    op.add_column("computation", _column("priority", "0", sa.Integer))
    op.add_column("computation", sa.Column("max_cost_s", sa.Float))
    op.create_index("computation_by_turn", "computation", ["state", "priority", "created"])


def _changed_jobs(op: Operations) -> None:
    """Make PostgreSQL notify servers of each transaction that changes the state of jobs.

    SQLite needs no trigger: its `data_version` changes with each transaction of another process.
    """
    if op.get_bind().dialect.name != "postgresql":
        return
    op.execute(_FUNCTION)
    for table, column in {"computation": "updated", "job": "dismissed"}.items():
        op.execute(
            f"CREATE TRIGGER {table}_changed AFTER UPDATE OF {column} ON {table} "
            "FOR EACH STATEMENT EXECUTE FUNCTION loa_job_changed()"
        )


def _projects(op: Operations) -> None:
    """Add the project of jobs and results; rows of earlier and former programs are in the common one."""
    op.add_column("job", _column("project"))
    op.create_index("job_by_project", "job", ["project", "created"])
    op.add_column("result", _column("project"))
    op.create_index("result_by_project", "result", ["project", "kind", "created"])


def _batches(op: Operations) -> None:
    """Add batches, which are jobs with child jobs, and the table of webhooks about jobs."""
    op.add_column("job", sa.Column("parent", sa.String))
    for name, kind in (("place", sa.Integer), ("children", sa.Integer), ("weight", sa.Float)):
        op.add_column("job", _column(name, "0", kind))
    op.create_index("job_by_parent", "job", ["parent"])
    op.create_table(
        "webhook",
        sa.Column("id", sa.String, primary_key=True),
        *_columns(sa.String, "job", "event"),
        sa.Column("uri", sa.Text, nullable=False),
        sa.Column("origin", sa.String, nullable=False),
        _column("state", "waiting"),
        _column("attempts", "0", sa.Integer),
        _column("due", "0", sa.Float),
        _column("lease"),
        _column("leased_until", "0", sa.Float),
        _column("message", kind=sa.Text),
        sa.Column("updated", sa.String, nullable=False),
    )
    op.create_index("webhook_by_job", "webhook", ["job"])
    op.create_index("webhook_by_state", "webhook", ["state", "due"])
    op.create_index("webhook_by_lease", "webhook", ["lease"])


def _one_owner(op: Operations) -> None:
    """Remove the owner and the lease of a computation: one server owns the whole table."""
    op.drop_index("computation_by_lease", "computation")
    for name in ("owner", "lease", "leased_until"):
        op.drop_column("computation", name)


def _lists_of_jobs(op: Operations) -> None:
    """Add the table by which lists of jobs are filtered and sorted, and an index of computations by key."""
    add_listing(op)
    op.create_index("computation_by_key", "computation", ["key", "state", "created"])


def _unused_indexes(op: Operations) -> None:
    """Remove indexes that no statement uses since lists have a table, and one that begins another index.

    The database chose `job_by_project` for the last job of a caller, and so read the jobs of all callers.
    """
    for name in ("job_by_caller", "job_by_project", "job_by_time", "job_by_use"):
        op.drop_index(name, "job")
    op.drop_index("computation_by_state", "computation")


STEPS: Mapping[str, Callable[[Operations], None]] = {
    "0001": _jobs_and_results,
    # computations that run during the step get no owner and an expired lease
    "0002": _added(
        *("computation", ("owner",), ("lease",), ("leased_until", "0", sa.Float)),
        computation_by_lease=["lease"],
    ),
    "0003": _uses_of_results,
    # the key of the caller who submitted a job; earlier jobs have none
    "0004": _added("job", ("caller",), job_by_caller=["caller"]),
    # the form in which a result is returned; earlier jobs had this one
    "0005": _added("job", ("delivery", "document reference")),
    "0006": _durations,
    "0007": _deployments,
    "0008": _terms_of_jobs,
    "0009": _added("computation", ("traceparent",)),  # earlier computations belong to no trace
    "0010": _changed_jobs,
    "0011": _added("computation", ("program",)),  # programs that do not know the column leave it empty
    "0012": _projects,
    "0013": _batches,
    # inputs as the caller stated them; earlier jobs, and those of former programs, have none
    "0014": _added("job", ("stated", "", sa.Text)),
    "0015": _one_owner,
    # the figures of a result in a list of jobs; earlier results get them when they are listed
    "0016": _added("result", ("headline", "", sa.Text)),
    "0017": _lists_of_jobs,
    # number of consecutive runs whose server or worker was lost; 0 for earlier computations
    "0018": _added("computation", ("lost_runs", "0", sa.Integer)),
    "0019": _unused_indexes,
}
REVISIONS = tuple(STEPS)
"""Numbers of all schemas, the newest last."""
