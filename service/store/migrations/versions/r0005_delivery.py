"""In which form the result of a job is wanted."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    """Add the column; jobs of before had the one form there was."""
    column = sa.Column("delivery", sa.String, nullable=False, server_default="document reference")
    op.add_column("job", column)
