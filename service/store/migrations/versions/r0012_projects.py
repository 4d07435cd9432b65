"""The projects of jobs and results."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"


def upgrade() -> None:
    """Add the columns; what was there before, or comes from a former program, is in the common project."""
    op.add_column("job", sa.Column("project", sa.String, nullable=False, server_default=""))
    op.create_index("job_by_project", "job", ["project", "created"])
    op.add_column("result", sa.Column("project", sa.String, nullable=False, server_default=""))
    op.create_index("result_by_project", "result", ["project", "kind", "created"])
