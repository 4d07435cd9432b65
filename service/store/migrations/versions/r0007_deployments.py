"""The deployment of the results in the index, and the lines that were rebuilt from files."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"


def upgrade() -> None:
    """Make the table; a deployment gets its name when it first opens its place of results."""
    op.create_table(
        "deployment",
        sa.Column("id", sa.String, primary_key=True),
        sa.Column("created", sa.String, nullable=False),
        sa.Column("checked", sa.String),
    )
    op.add_column("result", sa.Column("reindexed", sa.String))
