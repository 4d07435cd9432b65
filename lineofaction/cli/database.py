"""``loa database``."""

from __future__ import annotations

from typing import Any

import typer

from host.directories import keep_private
from lineofaction.cli.output import print_json
from lineofaction.gearbox.problems import EXIT_FAILED
from service.settings import load_settings
from service.store import DATABASE_FILE
from service.store.database import database_engine
from service.store.migrations import REVISIONS
from service.store.schema import Schema, shown

Json = dict[str, Any]


def run_upgrade(*, as_json: bool, **options: object) -> None:
    """Upgrade, and tell from which schema to which."""
    schema, name = _schema(options)
    before = schema.revision()
    schema.upgrade()
    facts: Json = {"database": name, "before": before, "schema": REVISIONS[-1]}
    _tell(facts, f"{name}: {before or 'no tables'} -> {REVISIONS[-1]}", as_json=as_json)


def run_status(*, as_json: bool, **options: object) -> None:
    """Tell both schemas; fail if this program cannot use that of the database."""
    schema, name = _schema(options)
    numbers, current = schema.numbers(), REVISIONS[-1]
    facts: Json = {"database": name, "schema": numbers.newest, "program": current}
    facts |= {"up_to_date": numbers.ours, "usable": numbers.usable}
    newer = f"newer, but this program ({current}) can use it"
    needed = newer if numbers.usable else f"this program needs {current}"
    state = "up to date" if numbers.ours else needed
    _tell(facts, f"{name}: {numbers.newest or 'no tables'}, {state}", as_json=as_json)
    if not numbers.usable:
        raise typer.Exit(EXIT_FAILED)


def _schema(options: dict[str, object]) -> tuple[Schema, str]:
    """Return the schema of the database of the settings, and the database's name."""
    settings = load_settings(**options)
    keep_private()
    engine = database_engine(
        settings.database_address or settings.data_directory / DATABASE_FILE, pooled=False
    )
    return Schema(engine), shown(engine)


def _tell(facts: Json, line: str, *, as_json: bool) -> None:
    """Print for a program or for people."""
    if as_json:
        print_json(facts)
    else:
        typer.echo(line)
