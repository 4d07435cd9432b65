"""Notifications of PostgreSQL when a job changed; SQLite tells by its data version."""

from __future__ import annotations

from alembic import op

revision = "0010"
down_revision = "0009"

_FUNCTION = """
CREATE FUNCTION loa_job_changed() RETURNS trigger LANGUAGE plpgsql
AS $$ BEGIN NOTIFY loa_jobs; RETURN NULL; END $$
"""
_TRIGGERS = {"computation": "updated", "job": "dismissed"}


def upgrade() -> None:
    """Notify at the end of each transaction that changes what callers see, whichever program makes it."""
    if op.get_bind().dialect.name != "postgresql":
        return
    op.execute(_FUNCTION)
    for table, column in _TRIGGERS.items():
        op.execute(
            f"CREATE TRIGGER {table}_changed AFTER UPDATE OF {column} ON {table} "
            "FOR EACH STATEMENT EXECUTE FUNCTION loa_job_changed()"
        )
