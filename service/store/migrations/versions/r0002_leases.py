"""The owner of a computation, its lease, and the end of that."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    """Add the columns; what runs now is nobody's, and its lease has ended."""
    op.add_column("computation", sa.Column("owner", sa.String, nullable=False, server_default=""))
    op.add_column("computation", sa.Column("lease", sa.String, nullable=False, server_default=""))
    op.add_column("computation", sa.Column("leased_until", sa.Float, nullable=False, server_default="0"))
    op.create_index("computation_by_lease", "computation", ["lease"])
