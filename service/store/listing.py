"""The table by which lists of jobs are filtered and sorted, and the triggers that maintain it.

Jobs and computations are wide rows with their inputs. A list reads narrow rows, its lines, by an index in the
order of the list. Triggers of the database maintain them, so that they are right for any program that writes,
also a former version.

A job has the rank 1 if it has or may have a result, 0 if it failed or was dismissed. Among the jobs of one
result in one batch, or outside batches, the newest of the highest rank then gets the rank 2.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import sqlalchemy as sa

if TYPE_CHECKING:
    from alembic.operations import Operations

NEWEST = 2
"""Rank of the newest job of a result."""
IN_VAIN = ("failed", "dismissed")
"""States of jobs without a result."""

INDEXES = {
    "listing_by_time": ("project", "parent", "created", "job", "seconds"),
    "listing_by_state": ("project", "parent", "state", "created", "job"),
    "listing_by_process": ("project", "parent", "process", "created", "job"),
    "listing_by_rank": ("project", "parent", "rank", "created", "job"),
    "listing_by_seconds": ("project", "parent", "seconds"),
    "listing_by_start": ("project", "parent", "running_since"),
    "listing_by_result": ("key", "parent", "rank", "created", "job"),
}
"""Columns of the indexes, in order. A list reads its entries in the order of time from one index."""

_TEXTS = ("job", "project", "parent", "created", "key", "process", "state", "title_folded", "tags")
_FAILED = f"IN {IN_VAIN}"
_NEWEST_OF_ALL = """
SELECT job FROM (
    SELECT job, row_number() OVER (
        PARTITION BY key, parent ORDER BY rank DESC, created DESC, job DESC
    ) AS turn FROM listing
) ranked WHERE turn = 1
"""
_SECONDS = {
    # to the microsecond: SQLite's own differences of instants are whole milliseconds
    "sqlite": "CAST(strftime('%s', {end}) AS INTEGER) - CAST(strftime('%s', {start}) AS INTEGER)"
    " + (CAST('0' || substr({end}, 20, 7) AS REAL) - CAST('0' || substr({start}, 20, 7) AS REAL))",
    "postgresql": "CAST(extract(epoch FROM CAST({end} AS timestamptz) - CAST({start} AS timestamptz))"
    " AS double precision)",
}
_JOINED = "FROM job AS j JOIN computation AS c ON c.id = j.computation_id"


def columns() -> tuple[sa.Column[object], ...]:
    """Return new columns of the table.

    `parent` is empty for a job outside batches. `seconds` is the time between start and end, None before the
    end and for a job that was never started. `running_since` is the start of a job that has not ended.
    """
    texts = (sa.Column(name, sa.String, primary_key=name == "job", nullable=False) for name in _TEXTS)
    return (
        *texts,
        sa.Column("seconds", sa.Float),
        sa.Column("running_since", sa.String),
        sa.Column("rank", sa.Integer, nullable=False),
    )


def add_listing(op: Operations) -> None:
    """Add the table with a line for each job there is, its indexes and its triggers."""
    dialect = op.get_bind().dialect.name
    op.create_table("listing", *columns())
    op.execute(f"INSERT INTO listing {_line(dialect)}")
    for name, index_columns in INDEXES.items():
        op.create_index(name, "listing", index_columns)
    op.execute(f"UPDATE listing SET rank = {NEWEST} WHERE job IN ({_NEWEST_OF_ALL})")
    for trigger in _triggers(dialect):
        for statement in trigger.statements(dialect):
            op.execute(statement)


def _values(dialect: str) -> dict[str, str]:
    """Return the SQL of a line's columns, by its job j and the job's computation c."""
    end = "coalesce(j.dismissed, c.finished)"
    state = "CASE WHEN j.dismissed IS NULL THEN c.state ELSE 'dismissed' END"
    return {
        "job": "j.id",
        "project": "j.project",
        "parent": "coalesce(j.parent, '')",
        "created": "j.created",
        "key": "c.key",
        "process": "c.process",
        "state": state,
        "title_folded": "j.title_folded",
        "tags": "j.tags",
        "seconds": _SECONDS[dialect].format(start="c.started", end=end),
        "running_since": f"CASE WHEN {end} IS NULL THEN c.started END",
        "rank": f"CASE WHEN {state} {_FAILED} THEN 0 ELSE 1 END",
    }


def _line(dialect: str, which: str = "") -> str:
    """Return the query of the lines of jobs."""
    values = ", ".join(f"{value} AS {name}" for name, value in _values(dialect).items())
    return f"SELECT {values} {_JOINED} {which}"


def _renewed(dialect: str, which: str) -> str:
    """Return the statement that brings lines up to date."""
    values = ", ".join(f"{name} = {value}" for name, value in _values(dialect).items() if name != "job")
    return f"UPDATE listing SET {values} {_JOINED} WHERE j.id = listing.job AND {which}"


def _election(row: str) -> tuple[str, str]:
    """Return the statements that elect the newest job of the result of `row`, and give it its rank."""
    same = f"key = {row}.key AND parent = {row}.parent"
    ordered = "ORDER BY rank DESC, created DESC, job DESC LIMIT 1"
    return (
        f"UPDATE listing SET rank = CASE WHEN state {_FAILED} THEN 0 ELSE 1 END"
        f" WHERE {same} AND rank = {NEWEST}",
        f"UPDATE listing SET rank = {NEWEST} WHERE job = (SELECT job FROM listing WHERE {same} {ordered})",
    )


class _Trigger(NamedTuple):
    """Statements that follow each change of a row."""

    name: str
    event: str
    body: tuple[str, ...]
    condition: str = ""

    def statements(self, dialect: str) -> Iterator[str]:
        """Yield the statements that make the trigger; PostgreSQL has it call a function."""
        body = " ".join(f"{statement};" for statement in self.body)
        when = f"WHEN ({self.condition})" if self.condition else ""
        head = f"CREATE TRIGGER {self.name} AFTER {self.event} FOR EACH ROW {when}"
        if dialect == "sqlite":
            yield f"{head} BEGIN {body} END"
            return
        function = f"loa_{self.name}()"
        yield (
            f"CREATE FUNCTION {function} RETURNS trigger LANGUAGE plpgsql "
            f"AS $$ BEGIN {body} RETURN NULL; END $$"
        )
        yield f"{head} EXECUTE FUNCTION {function}"


def _triggers(dialect: str) -> tuple[_Trigger, ...]:
    """Return the triggers.

    An update of a line always sets its state, so it calls an election. An election sets the rank alone, and
    so calls no other.
    """
    of_job = "dismissed, created, parent, project, computation_id, title_folded, tags"
    of_computation = "state, started, finished, key, process"
    entered = f"INSERT INTO listing {_line(dialect, 'WHERE j.id = NEW.id')}"
    another = "OLD.key <> NEW.key OR OLD.parent <> NEW.parent"
    return (
        _Trigger("job_listed", "INSERT ON job", (entered,)),
        _Trigger("job_relisted", f"UPDATE OF {of_job} ON job", (_renewed(dialect, "j.id = NEW.id"),)),
        _Trigger("job_unlisted", "DELETE ON job", ("DELETE FROM listing WHERE job = OLD.id",)),
        _Trigger(
            "computation_relisted",
            f"UPDATE OF {of_computation} ON computation",
            (_renewed(dialect, "j.computation_id = NEW.id"),),
        ),
        _Trigger("listing_entered", "INSERT ON listing", _election("NEW")),
        _Trigger("listing_renewed", "UPDATE OF state ON listing", _election("NEW")),
        _Trigger("listing_left", "DELETE ON listing", _election("OLD")),
        _Trigger("listing_moved", "UPDATE OF state ON listing", _election("OLD"), another),
    )
