"""What callers ask of a job beside its inputs."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"


def upgrade() -> None:
    """Add the columns; jobs of before have no label, no difference and no limit."""
    for name in ("title", "title_folded"):
        op.add_column("job", sa.Column(name, sa.String, nullable=False, server_default=""))
    for name in ("tags", "differences"):
        op.add_column("job", sa.Column(name, sa.Text, nullable=False, server_default=""))
    op.create_index("job_by_caller_and_time", "job", ["caller", "created"])
    op.add_column("computation", sa.Column("priority", sa.Integer, nullable=False, server_default="0"))
    op.add_column("computation", sa.Column("max_cost_s", sa.Float))
    op.create_index("computation_by_turn", "computation", ["state", "priority", "created"])
