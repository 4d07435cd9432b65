"""Arguments, help and examples of the verbs of a service: its jobs, keys, database, store and cache."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from lineofaction.cli.guard import computing, guarded
from lineofaction.cli.options import DEFAULT_SERVICE, AsJson, Service, to_file
from lineofaction.cli.overrides import file_argument, overridable
from lineofaction.cli.verb_parameters import grouped
from lineofaction.cli.verbs import Later
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.registry import studies_of

if TYPE_CHECKING:
    from lineofaction.cli import cache as cache_verbs
    from lineofaction.cli import job_tables, keys, remote, serve, stored_results, submit
else:
    cache_verbs, remote, serve, submit = map(Later, ("cli.cache", "cli.remote", "cli.serve", "cli.submit"))
    job_tables, keys, stored_results = map(Later, ("cli.job_tables", "cli.keys", "cli.stored_results"))

verbs = typer.Typer()

DataDirectory = Annotated[
    Path | None, typer.Option(help="Directory of jobs and results [LOA_DATA_DIRECTORY].")
]
Workers = Annotated[int | None, typer.Option(help="Jobs at the same time [LOA_WORKERS].")]
access_keys = typer.Typer(help="Access keys of a service.", no_args_is_help=True)
Name = Annotated[str, typer.Argument(help="Name of the key's owner.")]
KeysFile = Annotated[
    Path | None,
    typer.Option("--file", help="File of keys [LOA_KEYS_FILE; keys.json in the data directory]."),
]
Expires = Annotated[
    str | None, typer.Option(help="Hours, days or weeks for which the key is good: 12h, 90d, 26w.")
]
database = typer.Typer(help="The database of jobs: its schema.", no_args_is_help=True)
store = typer.Typer(help="The store of results: verify, collect, reindex.", no_args_is_help=True)
cache = typer.Typer(
    help="The cache of gears, results, searches and studies on this machine.", no_args_is_help=True
)


@verbs.command("serve", rich_help_panel="service", epilog="Example: loa serve --port 8321 --workers 2")
@guarded
def _serve(
    host: Annotated[
        str | None,
        typer.Option(help="Address to listen on; loopback only without access keys [LOA_HOST]."),
    ] = None,
    port: Annotated[int | None, typer.Option(help="Port; 0 selects a free one [LOA_PORT].")] = None,
    data_directory: DataDirectory = None,
    workers: Workers = None,
    processes: Annotated[
        int | None, typer.Option(help="Processes that answer requests [LOA_PROCESSES].")
    ] = None,
) -> None:
    """Serve jobs and results over HTTP on this machine, until stopped."""
    settings = {"host": host, "port": port, "data_directory": data_directory}
    serve.run_serve(**settings, workers=workers, processes=processes)


@dataclass(frozen=True)
class _TermOptions:
    """The terms of a job."""

    title: Annotated[str, typer.Option(help="Name of the job in lists.")] = ""
    tag: Annotated[list[str] | None, typer.Option(help="Tag of the job; may be repeated.")] = None
    priority: Annotated[int, typer.Option(help="-9 to 9; the highest is next.")] = 0
    max_cost_s: Annotated[
        float | None, typer.Option("--max-cost", help="CPU seconds that the job may take; default: no limit.")
    ] = None

    @property
    def as_sent(self) -> dict[str, Any]:
        """Return the terms of a job as the client takes them."""
        limits = {"priority": self.priority, "max_cost_s": self.max_cost_s}
        return {"title": self.title, "tags": tuple(self.tag or ()), **limits}


@verbs.command(
    "submit",
    rich_help_panel="service",
    epilog="Example: loa submit examples/palermo_spur_20_20.toml --wait -o ste.nc",
)
@computing
@overridable("file", "case or scene")
@grouped
def _submit(
    *,
    file: Annotated[InputFile, file_argument("Case or scene file", "FILE")],
    service: Service = DEFAULT_SERVICE,
    wait: Annotated[bool, typer.Option("--wait", help="Wait for the result.")] = False,
    output: Annotated[Path | None, to_file("Wait for the result and write it to this file.")] = None,
    process: Annotated[
        str | None,
        typer.Option(
            help=f"On a case analyze (default), {', '.join(studies_of('case'))}; on a scene simulate "
            f"(default), {', '.join(studies_of('scene'))}; on both {', '.join(studies_of('case or scene'))}."
        ),
    ] = None,
    inputs: Annotated[
        str | None, typer.Option(help="Further inputs of that process, as a JSON object.")
    ] = None,
    terms: _TermOptions,
    json: AsJson = False,
) -> None:
    """Submit a case or a scene to a service."""
    job = process, inputs, terms.as_sent
    submit.run_submit(file, service, *job, wait=wait, output=output, as_json=json)


@verbs.command(
    "fetch",
    rich_help_panel="service",
    epilog="Example: loa fetch 3f1c0e5a-6c3d-4c1e-9b1e-2f6f0a1b2c3d -o ste.nc",
)
@computing
def _fetch(
    name: Annotated[
        str,
        typer.Argument(
            help="Identifier of a job, content hash of a result, or address of the page in quotes."
        ),
    ],
    output: Annotated[
        Path, to_file("File to write: netCDF or JSON, by its kind; of an address as .toml its case.")
    ],
    service: Annotated[
        str | None,
        typer.Option(
            "--service",
            envvar="LOA_SERVICE",
            help="Address of the service.",
            show_default=f"{DEFAULT_SERVICE}, or that of the address",
        ),
    ] = None,
    wait: Annotated[bool, typer.Option("--wait", help="Wait for the job.")] = False,
    json: AsJson = False,
) -> None:
    """Fetch a result by its job or hash, or the case or result that an address of the page shows."""
    submit.run_fetch(name, output, service, wait=wait, as_json=json)


@verbs.command("jobs", rich_help_panel="service", epilog="Example: loa jobs --status running")
@guarded
def _jobs(
    process: Annotated[list[str] | None, typer.Option(help="Only of this process; may be repeated.")] = None,
    status: Annotated[
        list[str] | None,
        typer.Option(help="Only accepted, running, successful, failed or dismissed ones; may be repeated."),
    ] = None,
    limit: Annotated[int, typer.Option(help="Most jobs to list.", min=1)] = 20,
    service: Service = DEFAULT_SERVICE,
    json: AsJson = False,
) -> None:
    """List the jobs of a service, the newest first."""
    remote.run_jobs(service, process or (), status or (), limit, as_json=json)


@verbs.command(
    "dismiss", rich_help_panel="service", epilog="Example: loa dismiss 3f1c0e5a-6c3d-4c1e-9b1e-2f6f0a1b2c3d"
)
@guarded
def _dismiss(
    job: Annotated[str, typer.Argument(help="Identifier of a job.")],
    service: Service = DEFAULT_SERVICE,
    json: AsJson = False,
) -> None:
    """Cancel a job of a service; its work ends unless other jobs share it."""
    remote.run_dismiss(job, service, as_json=json)


@dataclass(frozen=True)
class _KeyLimits:
    """The limits of a key; None: none."""

    requests_per_minute: Annotated[
        int | None, typer.Option(help="Requests per minute; default: no limit.")
    ] = None
    unfinished_jobs: Annotated[
        int | None, typer.Option(help="Limit on waiting and running jobs; default: no limit.")
    ] = None
    highest_priority: Annotated[
        int | None, typer.Option(help="Highest priority of the key's jobs, -9 to 9; default: any.")
    ] = None
    max_cost_s: Annotated[
        int | None, typer.Option("--max-cost", help="CPU seconds of a job; default: no limit.")
    ] = None
    connections: Annotated[
        int | None, typer.Option(help="Limit on requests answered at the same time; default: a quarter.")
    ] = None
    streams: Annotated[int | None, typer.Option(help="Limit on open event streams; default: no limit.")] = (
        None
    )


@access_keys.command("add", epilog="Example: loa keys add test-bench-3 --expires 90d --scopes read,submit")
@guarded
@grouped
def _add(
    *,
    name: Name,
    project: Annotated[
        str | None, typer.Option(help="Project whose jobs and results the key sees; default: the common one.")
    ] = None,
    scopes: Annotated[
        str | None, typer.Option(help="Scopes of the key among read,submit,dismiss,operate; default: all.")
    ] = None,
    expires: Expires = None,
    limits: _KeyLimits,
    file: KeysFile = None,
    json: AsJson = False,
) -> None:
    """Create a key, print it once, and store its hash."""
    rights = {"scopes": scopes, "expires": expires, "project": project, **asdict(limits)}
    keys.Keys(file, as_json=json).add(name, **rights)


@access_keys.command("rotate", epilog="Example: loa keys rotate test-bench-3 --overlap 7d")
@guarded
def _rotate(
    name: Name,
    overlap: Annotated[str, typer.Option(help="For how long the old key is good beside the new one.")] = "0h",
    expires: Expires = None,
    file: KeysFile = None,
    json: AsJson = False,
) -> None:
    """Create the next key of a name, with the rights of the old one, which ends after the overlap."""
    keys.Keys(file, as_json=json).rotate(name, overlap, expires)


@access_keys.command("list")
@guarded
def _list_keys(file: KeysFile = None, json: AsJson = False) -> None:
    """Print names, projects, scopes, ends and limits of all keys."""
    keys.Keys(file, as_json=json).show()


@access_keys.command("remove", epilog="Example: loa keys remove test-bench-3")
@guarded
def _remove(name: Name, file: KeysFile = None) -> None:
    """Remove a key; running services refuse it from the next request on."""
    keys.Keys(file).remove(name)


@database.command("upgrade", epilog="Example: LOA_DATABASE_URL=postgresql://loa@db/loa loa database upgrade")
@guarded
def _upgrade(data_directory: DataDirectory = None, json: AsJson = False) -> None:
    """Upgrade the tables, or create them; no data are lost."""
    job_tables.JobTables(data_directory, as_json=json).upgrade()


@database.command("status", epilog="Example: loa database status --json")
@guarded
def _status(data_directory: DataDirectory = None, json: AsJson = False) -> None:
    """Print the schema of the database and of this program; exit code 1 if they differ."""
    job_tables.JobTables(data_directory, as_json=json).status()


@store.command("verify", epilog="Example: loa store verify --json")
@guarded
def _verify(data_directory: DataDirectory = None, json: AsJson = False) -> None:
    """Compare files with their digests, set damaged ones aside; exit code 1 if one is damaged or missing."""
    stored_results.Results(data_directory, as_json=json).verify()


@store.command("gc", epilog="Example: loa store gc --dry-run --older-than 90")
@guarded
def _gc(
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
    stored_results.Results(data_directory, as_json=json).collect(dry_run=dry_run, older_than=older_than)


@store.command("reindex", epilog="Example: loa store reindex --json")
@guarded
def _reindex(
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
    stored_results.Results(data_directory, as_json=json).reindex(quarantined=quarantined)


@cache.command("list", epilog="Example: loa cache list --json")
@guarded
def _list_cache(json: AsJson = False) -> None:
    """Print the number of files and their size, by kind."""
    cache_verbs.run_list(as_json=json)


@cache.command("limit", epilog="Example: loa cache limit --gb 0.5")
@guarded
def _limit(
    gb: Annotated[float | None, typer.Option(min=0.0, help="Default: LOA_CACHE_BYTES, or 2 GB.")] = None,
    json: AsJson = False,
) -> None:
    """Remove the least recently used entries until the rest fits; entries used within 10 minutes stay."""
    cache_verbs.run_limit(gb, as_json=json)


@cache.command("clear", epilog="Example: loa cache clear results")
@guarded
def _clear(
    kinds: Annotated[
        list[str] | None, typer.Argument(help="compliance, results, searches, studies; default: all.")
    ] = None,
    json: AsJson = False,
) -> None:
    """Remove all entries; they are computed or fetched again when needed."""
    cache_verbs.run_clear(kinds or [], as_json=json)
