"""Verbs of the database and the store of a service."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli.guard import guarded
from service.cli.verbs.options import AsJson

database = typer.Typer(help="The database of jobs: its schema.", no_args_is_help=True)

store = typer.Typer(help="The store of results: verify, collect, reindex.", no_args_is_help=True)

cache = typer.Typer(help="What is kept on this machine to be quicker the next time.", no_args_is_help=True)

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
    """Tell the schema of the database and that of this program; exit code 1 if they differ."""
    from service.cli.database import run_status  # noqa: PLC0415 (start-up time)

    run_status(as_json=json, data_directory=data_directory)


@store.command(epilog="Example: loa store verify --json")
@guarded
def verify(data_directory: DataDirectory = None, json: AsJson = False) -> None:
    """Compare every file with its digest, set damaged ones aside; exit code 1 if one is damaged or gone."""
    from service.cli.store import run_verify  # noqa: PLC0415 (start-up time)

    run_verify(as_json=json, data_directory=data_directory)


@store.command(epilog="Example: loa store gc --dry-run --older-than 90")
@guarded
def gc(
    data_directory: DataDirectory = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Tell what would be removed.")] = False,
    older_than: Annotated[
        float | None,
        typer.Option(
            min=0.0, help="Also results and ended jobs not requested in so many days [LOA_RETENTION_DAYS]."
        ),
    ] = None,
    json: AsJson = False,
) -> None:
    """Remove what is left over: files without index, lines without file, workspaces, logs, what expired.

    Files of results go to quarantine, for LOA_QUARANTINE_DAYS.
    """
    from service.cli.store import run_gc  # noqa: PLC0415 (start-up time)

    run_gc(as_json=json, dry_run=dry_run, older_than=older_than, data_directory=data_directory)


@store.command(epilog="Example: loa store reindex --json")
@guarded
def reindex(
    data_directory: DataDirectory = None,
    quarantined: Annotated[
        bool, typer.Option("--quarantined", help="First move back what is in quarantine.")
    ] = False,
    json: AsJson = False,
) -> None:
    """Rebuild the index from the files: after the loss of the database, or with one from before.

    The files become those of this database: a service that had them removes none of them any more, and is
    refused at its next start. Exit code 3 if a file is damaged.
    """
    from service.cli.store import run_reindex  # noqa: PLC0415 (start-up time)

    run_reindex(as_json=json, quarantined=quarantined, data_directory=data_directory)


@cache.command("list", epilog="Example: loa cache list --json")
@guarded
def list_cache(json: AsJson = False) -> None:
    """Print how many files and bytes are kept, by kind."""
    from service.cli.cache import run_list  # noqa: PLC0415 (start-up time)

    run_list(as_json=json)


@cache.command(epilog="Example: loa cache limit --gb 0.5")
@guarded
def limit(
    gb: Annotated[float | None, typer.Option(min=0.0, help="Default: LOA_CACHE_BYTES, or 2 GB.")] = None,
    json: AsJson = False,
) -> None:
    """Remove what was not used for longest until the rest fits; what was used within 10 minutes stays."""
    from service.cli.cache import run_limit  # noqa: PLC0415 (start-up time)

    run_limit(gb, as_json=json)


@cache.command(epilog="Example: loa cache clear results")
@guarded
def clear(
    kinds: Annotated[
        list[str] | None, typer.Argument(help="compliance, results, searches, studies; none named: all.")
    ] = None,
    json: AsJson = False,
) -> None:
    """Remove all that is kept; it is computed or fetched again when it is needed."""
    from service.cli.cache import run_clear  # noqa: PLC0415 (start-up time)

    run_clear(kinds or [], as_json=json)
