"""The trace of a computation."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"


def upgrade() -> None:
    """Add the column; what was entered before belongs to no trace."""
    op.add_column("computation", sa.Column("traceparent", sa.String, nullable=False, server_default=""))
