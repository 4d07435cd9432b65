"""The inputs of a job as its caller stated them."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"


def upgrade() -> None:
    """Add the column; jobs of before, or of a former program, have the inputs of their computation alone."""
    op.add_column("job", sa.Column("stated", sa.Text, nullable=False, server_default=""))
