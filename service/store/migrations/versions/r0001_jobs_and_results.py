"""Jobs, computations, and the index of results."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Make the tables."""
    _make_computations()
    _make_jobs()
    op.create_table(
        "result",
        sa.Column("key", sa.String, primary_key=True),
        sa.Column("kind", sa.String, primary_key=True),
        sa.Column("sha256", sa.String, nullable=False),
        sa.Column("size", sa.BigInteger, nullable=False),
        sa.Column("created", sa.String, nullable=False),
    )


def _make_computations() -> None:
    """Make the table of computations: at most one of a key waits or runs."""
    op.create_table(
        "computation",
        sa.Column("id", sa.String, primary_key=True),
        sa.Column("process", sa.String, nullable=False),
        sa.Column("key", sa.String, nullable=False),
        sa.Column("inputs", sa.Text, nullable=False),
        sa.Column("state", sa.String, nullable=False),
        sa.Column("stage", sa.String, nullable=False),
        sa.Column("stage_fraction", sa.Float, nullable=False),
        sa.Column("fraction", sa.Float, nullable=False),
        sa.Column("message", sa.Text, nullable=False),
        sa.Column("faults", sa.Text, nullable=False),
        sa.Column("reference", sa.String, nullable=False),
        sa.Column("attempts", sa.Integer, nullable=False),
        sa.Column("created", sa.String, nullable=False),
        sa.Column("started", sa.String),
        sa.Column("finished", sa.String),
        sa.Column("updated", sa.String, nullable=False),
    )
    live = sa.text("state IN ('accepted', 'running')")
    op.create_index(
        "computation_in_flight",
        "computation",
        ["key"],
        unique=True,
        sqlite_where=live,
        postgresql_where=live,
    )
    op.create_index("computation_by_state", "computation", ["state", "created"])


def _make_jobs() -> None:
    op.create_table(
        "job",
        sa.Column("id", sa.String, primary_key=True),
        sa.Column("computation_id", sa.String, sa.ForeignKey("computation.id"), nullable=False),
        sa.Column("created", sa.String, nullable=False),
        sa.Column("dismissed", sa.String),
    )
    op.create_index("job_by_computation", "job", ["computation_id"])
    op.create_index("job_by_time", "job", ["created"])
