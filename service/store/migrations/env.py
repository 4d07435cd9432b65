"""Alembic's entry point: it runs the steps in the transaction it is given."""

from __future__ import annotations

from alembic import context

from service.store.schema import NEWEST

context.configure(
    connection=context.config.attributes["connection"], version_table=NEWEST, transactional_ddl=True
)
with context.begin_transaction():
    context.run_migrations()
