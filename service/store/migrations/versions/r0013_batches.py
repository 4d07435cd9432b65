"""Batches: jobs that are parents of others. Calls about jobs to other services."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"


def upgrade() -> None:
    """Add the columns; jobs of before have neither parent nor children."""
    op.add_column("job", sa.Column("parent", sa.String))
    op.add_column("job", sa.Column("place", sa.Integer, nullable=False, server_default="0"))
    op.add_column("job", sa.Column("children", sa.Integer, nullable=False, server_default="0"))
    op.add_column("job", sa.Column("weight", sa.Float, nullable=False, server_default="0"))
    op.create_index("job_by_parent", "job", ["parent"])
    _add_webhooks()


def _add_webhooks() -> None:
    """Make the table of calls."""
    op.create_table(
        "webhook",
        sa.Column("id", sa.String, primary_key=True),
        *(sa.Column(name, sa.String, nullable=False) for name in ("job", "event")),
        sa.Column("uri", sa.Text, nullable=False),
        sa.Column("origin", sa.String, nullable=False),
        sa.Column("state", sa.String, nullable=False, server_default="waiting"),
        sa.Column("attempts", sa.Integer, nullable=False, server_default="0"),
        sa.Column("due", sa.Float, nullable=False, server_default="0"),
        sa.Column("lease", sa.String, nullable=False, server_default=""),
        sa.Column("leased_until", sa.Float, nullable=False, server_default="0"),
        sa.Column("message", sa.Text, nullable=False, server_default=""),
        sa.Column("updated", sa.String, nullable=False),
    )
    op.create_index("webhook_by_job", "webhook", ["job"])
    op.create_index("webhook_by_state", "webhook", ["state", "due"])
    op.create_index("webhook_by_lease", "webhook", ["lease"])
