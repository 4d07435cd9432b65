"""Verbs of the database and the store of a service."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli.guard import guarded
from service.cli.verbs.options import AsJson

database = typer.Typer(help="The database of jobs: its schema.", no_args_is_help=True)

DataDirectory = Annotated[
    Path | None, typer.Option(help="Directory of jobs and results [LOA_DATA_DIRECTORY].")
]


@database.command(epilog="Example: LOA_DATABASE_URL=postgresql://loa@db/loa loa database upgrade")
@guarded
def upgrade(data_directory: DataDirectory = None, json: AsJson = False) -> None:
    """Bring the tables up to date, or make them; nothing is lost."""
    from service.cli.database import run_upgrade  # noqa: PLC0415 (start-up time)

    run_upgrade(as_json=json, data_directory=data_directory)


@database.command(epilog="Example: loa database status --json")
@guarded
def status(data_directory: DataDirectory = None, json: AsJson = False) -> None:
    """Tell the schema of the database and that of this program; exit code 3 if they differ."""
    from service.cli.database import run_status  # noqa: PLC0415 (start-up time)

    run_status(as_json=json, data_directory=data_directory)
