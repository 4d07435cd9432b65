"""Names of the files of results, and when results and jobs were last requested."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"

_NAMES = """
UPDATE result SET used = created, file = kind || '/' || substr("key", 1, 2) || '/' || "key"
    || CASE WHEN kind IN ('ablation', 'frontier') THEN '.json' ELSE '.nc' END
"""


def upgrade() -> None:
    """Add the columns; files had the names of their keys, and were last used when they were made."""
    op.add_column("result", sa.Column("file", sa.String, nullable=False, server_default=""))
    op.add_column("result", sa.Column("used", sa.String, nullable=False, server_default=""))
    op.execute(_NAMES)
    op.create_index("result_by_use", "result", ["used"])
    op.add_column("job", sa.Column("asked", sa.String))
    op.create_index("job_by_use", "job", ["asked"])
