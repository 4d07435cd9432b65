"""What callers ask of a job beside its inputs."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"


def upgrade() -> None:
    """Add the columns; jobs of before have no label and are not compared."""
    for name in ("title", "title_folded"):
        op.add_column("job", sa.Column(name, sa.String, nullable=False, server_default=""))
    for name in ("tags", "differences"):
        op.add_column("job", sa.Column(name, sa.Text, nullable=False, server_default=""))
    op.create_index("job_by_caller_and_time", "job", ["caller", "created"])
