"""Verbs of access keys: ``loa keys add``, ``rotate``, ``list`` and ``remove``."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import typer

from lineofaction.cli.guard import guarded
from lineofaction.cli.signature import grouped
from lineofaction.cli.verbs.options import AsJson

verbs = typer.Typer(help="Access keys of a service.", no_args_is_help=True)

Name = Annotated[str, typer.Argument(help="Name of the key's owner.")]
KeysFile = Annotated[
    Path | None,
    typer.Option("--file", help="File of keys [LOA_KEYS_FILE; keys.json in the data directory]."),
]
Expires = Annotated[
    str | None, typer.Option(help="Hours, days or weeks for which the key is good: 12h, 90d, 26w.")
]


@dataclass(frozen=True)
class KeyLimits:
    """The limits of a key; None: none."""

    requests_per_minute: Annotated[int | None, typer.Option(help="Default: no limit.")] = None
    unfinished_jobs: Annotated[
        int | None, typer.Option(help="Limit on waiting and running jobs; default: no limit.")
    ] = None
    highest_priority: Annotated[int | None, typer.Option(help="Of its jobs, -9 to 9; default: any.")] = None
    max_cost_s: Annotated[
        int | None, typer.Option("--max-cost", help="CPU seconds of a job; default: no limit.")
    ] = None
    connections: Annotated[
        int | None, typer.Option(help="Limit on requests answered at the same time; default: a quarter.")
    ] = None
    streams: Annotated[int | None, typer.Option(help="Limit on open event streams; default: no limit.")] = (
        None
    )


@verbs.command(epilog="Example: loa keys add test-bench-3 --expires 90d --scopes read,submit")
@guarded
@grouped
def add(
    *,
    name: Name,
    project: Annotated[
        str | None, typer.Option(help="Project whose jobs and results the key sees; default: the common one.")
    ] = None,
    scopes: Annotated[str | None, typer.Option(help="Of read,submit,dismiss,operate; default: all.")] = None,
    expires: Expires = None,
    limits: KeyLimits,
    file: KeysFile = None,
    json: AsJson = False,
) -> None:
    """Create a key, print it once, and store its hash."""
    from lineofaction.cli.keys import run_add  # noqa: PLC0415 (start-up time)

    run_add(name, file, as_json=json, scopes=scopes, expires=expires, project=project, **asdict(limits))


@verbs.command(epilog="Example: loa keys rotate test-bench-3 --overlap 7d")
@guarded
def rotate(
    name: Name,
    overlap: Annotated[str, typer.Option(help="For how long the old key is good beside the new one.")] = "0h",
    expires: Expires = None,
    file: KeysFile = None,
    json: AsJson = False,
) -> None:
    """Create the next key of a name, with the rights of the old one, which ends after the overlap."""
    from lineofaction.cli.keys import run_rotate  # noqa: PLC0415 (start-up time)

    run_rotate(name, file, overlap, expires, as_json=json)


@verbs.command("list")
@guarded
def list_keys(file: KeysFile = None, json: AsJson = False) -> None:
    """Print names, projects, scopes, ends and limits of all keys."""
    from lineofaction.cli.keys import run_list  # noqa: PLC0415 (start-up time)

    run_list(file, as_json=json)


@verbs.command(epilog="Example: loa keys remove test-bench-3")
@guarded
def remove(name: Name, file: KeysFile = None) -> None:
    """Remove a key; running services refuse it from the next request on."""
    from lineofaction.cli.keys import run_remove  # noqa: PLC0415 (start-up time)

    run_remove(name, file)
