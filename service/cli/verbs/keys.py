"""Verbs of access keys: ``loa keys add``, ``list`` and ``remove``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli.guard import guarded
from service.cli.verbs.options import AsJson

verbs = typer.Typer(help="Access keys of a service.", no_args_is_help=True)

Name = Annotated[str, typer.Argument(help="Name of the key's owner.")]
KeysFile = Annotated[
    Path | None,
    typer.Option("--file", help="File of keys [LOA_KEYS_FILE; keys.json in the data directory]."),
]


@verbs.command(epilog="Example: loa keys add test-bench-3 --requests-per-minute 600")
@guarded
def add(
    name: Name,
    requests_per_minute: Annotated[int | None, typer.Option(help="Default: no limit.")] = None,
    unfinished_jobs: Annotated[
        int | None, typer.Option(help="Limit on waiting and running jobs; default: no limit.")
    ] = None,
    highest_priority: Annotated[int | None, typer.Option(help="Of its jobs, -9 to 9; default: any.")] = None,
    max_cost_s: Annotated[
        int | None, typer.Option("--max-cost", help="CPU seconds of a job; default: no limit.")
    ] = None,
    file: KeysFile = None,
    json: AsJson = False,
) -> None:
    """Create a key, print it once, and store its hash."""
    from service.cli.keys import run_add  # noqa: PLC0415 (start-up time)

    limits = {"requests_per_minute": requests_per_minute, "unfinished_jobs": unfinished_jobs}
    limits |= {"highest_priority": highest_priority, "max_cost_s": max_cost_s}
    run_add(name, file, as_json=json, **limits)


@verbs.command("list")
@guarded
def list_keys(file: KeysFile = None, json: AsJson = False) -> None:
    """Print names and limits of all keys."""
    from service.cli.keys import run_list  # noqa: PLC0415 (start-up time)

    run_list(file, as_json=json)


@verbs.command(epilog="Example: loa keys remove test-bench-3")
@guarded
def remove(name: Name, file: KeysFile = None) -> None:
    """Remove a key; running services refuse it from the next request on."""
    from service.cli.keys import run_remove  # noqa: PLC0415 (start-up time)

    run_remove(name, file)
