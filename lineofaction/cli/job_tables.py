"""``loa database``: upgrade and state of the database of a service."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer

from host.directories import keep_private
from lineofaction.cli.output import print_json
from lineofaction.gearbox.problems import EXIT_FAILED
from service.settings import load_settings
from service.store.database import Schema, database_engine, redacted_url
from service.store.migrations import REVISIONS
from service.store.places import DATABASE_FILE

Json = dict[str, Any]


class JobTables:
    """The tables of jobs in the database of the settings."""

    def __init__(self, data_directory: Path | None, *, as_json: bool) -> None:
        settings = load_settings(data_directory=data_directory)
        keep_private()
        engine = database_engine(
            settings.database_address or settings.data_directory / DATABASE_FILE, pooled=False
        )
        self._schema, self._name, self._as_json = Schema(engine), redacted_url(engine), as_json

    def upgrade(self) -> None:
        """Upgrade, and tell from which schema to which."""
        before = self._schema.revision()
        self._schema.upgrade()
        answer: Json = {"database": self._name, "before": before, "schema": REVISIONS[-1]}
        self._tell(answer, f"{before or 'no tables'} -> {REVISIONS[-1]}")

    def status(self) -> None:
        """Print both schemas; fail if this program cannot use the schema of the database."""
        numbers, current = self._schema.numbers(), REVISIONS[-1]
        answer: Json = {"database": self._name, "schema": numbers.newest, "program": current}
        answer |= {"up_to_date": numbers.ours, "usable": numbers.usable}
        newer = f"newer, but this program ({current}) can use it"
        needed = newer if numbers.usable else f"this program needs {current}"
        self._tell(answer, f"{numbers.newest or 'no tables'}, {'up to date' if numbers.ours else needed}")
        if not numbers.usable:
            raise typer.Exit(EXIT_FAILED)

    def _tell(self, answer: Json, state: str) -> None:
        if self._as_json:
            print_json(answer)
        else:
            typer.echo(f"{self._name}: {state}")
