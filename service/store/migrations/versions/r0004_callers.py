"""The key that a job was entered with."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"


def upgrade() -> None:
    """Add the column; jobs of before are nobody's."""
    op.add_column("job", sa.Column("caller", sa.String, nullable=False, server_default=""))
    op.create_index("job_by_caller", "job", ["caller"])
