"""Verbs of the database and the store of a service."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lineofaction.cli.guard import guarded
from lineofaction.cli.verbs.options import AsJson

database = typer.Typer(help="The database of jobs: its schema.", no_args_is_help=True)

store = typer.Typer(help="The store of results: verify, collect, reindex.", no_args_is_help=True)

cache = typer.Typer(
    help="The cache of gears, results, searches and studies on this machine.", no_args_is_help=True
)

DataDirectory = Annotated[
    Path | None, typer.Option(help="Directory of jobs and results [LOA_DATA_DIRECTORY].")
]


@database.command(epilog="Example: LOA_DATABASE_URL=postgresql://loa@db/loa loa database upgrade")
@guarded
def upgrade(data_directory: DataDirectory = None, json: AsJson = False) -> None:
    """Upgrade the tables, or create them; no data are lost."""
    from lineofaction.cli.database import run_upgrade  # noqa: PLC0415 (start-up time)

    run_upgrade(as_json=json, data_directory=data_directory)


@database.command(epilog="Example: loa database status --json")
@guarded
def status(data_directory: DataDirectory = None, json: AsJson = False) -> None:
    """Print the schema of the database and of this program; exit code 1 if they differ."""
    from lineofaction.cli.database import run_status  # noqa: PLC0415 (start-up time)

    run_status(as_json=json, data_directory=data_directory)


@store.command(epilog="Example: loa store verify --json")
@guarded
def verify(data_directory: DataDirectory = None, json: AsJson = False) -> None:
    """Compare files with their digests, set damaged ones aside; exit code 1 if one is damaged or missing."""
    from lineofaction.cli.store import run_verify  # noqa: PLC0415 (start-up time)

    run_verify(as_json=json, data_directory=data_directory)


@store.command(epilog="Example: loa store gc --dry-run --older-than 90")
@guarded
def gc(
    data_directory: DataDirectory = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="List what would be removed.")] = False,
    older_than: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            help="Also remove results and ended jobs not requested for this many days [LOA_RETENTION_DAYS].",
        ),
    ] = None,
    json: AsJson = False,
) -> None:
    """Remove orphaned files and index lines, old workspaces and logs, and expired results.

    Files of results go to quarantine, for LOA_QUARANTINE_DAYS.
    """
    from lineofaction.cli.store import run_gc  # noqa: PLC0415 (start-up time)

    run_gc(as_json=json, dry_run=dry_run, older_than=older_than, data_directory=data_directory)


@store.command(epilog="Example: loa store reindex --json")
@guarded
def reindex(
    data_directory: DataDirectory = None,
    quarantined: Annotated[
        bool, typer.Option("--quarantined", help="First restore the files in quarantine.")
    ] = False,
    json: AsJson = False,
) -> None:
    """Rebuild the index from the files, after the loss of the database or with an older database.

    The files become those of this database: a service that had them removes none of them any more, and is
    refused at its next start. Exit code 3 if a file is damaged.
    """
    from lineofaction.cli.store import run_reindex  # noqa: PLC0415 (start-up time)

    run_reindex(as_json=json, quarantined=quarantined, data_directory=data_directory)


@cache.command("list", epilog="Example: loa cache list --json")
@guarded
def list_cache(json: AsJson = False) -> None:
    """Print the number of files and their size, by kind."""
    from lineofaction.cli.cache import run_list  # noqa: PLC0415 (start-up time)

    run_list(as_json=json)


@cache.command(epilog="Example: loa cache limit --gb 0.5")
@guarded
def limit(
    gb: Annotated[float | None, typer.Option(min=0.0, help="Default: LOA_CACHE_BYTES, or 2 GB.")] = None,
    json: AsJson = False,
) -> None:
    """Remove the least recently used entries until the rest fits; entries used within 10 minutes stay."""
    from lineofaction.cli.cache import run_limit  # noqa: PLC0415 (start-up time)

    run_limit(gb, as_json=json)


@cache.command(epilog="Example: loa cache clear results")
@guarded
def clear(
    kinds: Annotated[
        list[str] | None, typer.Argument(help="compliance, results, searches, studies; default: all.")
    ] = None,
    json: AsJson = False,
) -> None:
    """Remove all entries; they are computed or fetched again when needed."""
    from lineofaction.cli.cache import run_clear  # noqa: PLC0415 (start-up time)

    run_clear(kinds or [], as_json=json)
