"""The program that entered a computation: whose name its result has."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"


def upgrade() -> None:
    """Add the column; programs that do not know it leave it empty."""
    op.add_column("computation", sa.Column("program", sa.String, nullable=False, server_default=""))
