"""Verbs of the service and its client."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from lineofaction.cli.guard import computing, guarded
from lineofaction.cli.signature import grouped
from lineofaction.cli.verbs.options import DEFAULT_SERVICE, AsJson, Service
from lineofaction.cli.verbs.overrides import file_argument, overridable
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.registry import studies_of

verbs = typer.Typer()


@verbs.command(epilog="Example: loa serve --port 8321 --workers 2")
@guarded
def serve(
    host: Annotated[
        str | None,
        typer.Option(help="Address to listen on; loopback only without access keys [LOA_HOST]."),
    ] = None,
    port: Annotated[int | None, typer.Option(help="Port; 0 selects a free one [LOA_PORT].")] = None,
    data_directory: Annotated[
        Path | None, typer.Option(help="Directory of jobs and results [LOA_DATA_DIRECTORY].")
    ] = None,
    workers: Annotated[int | None, typer.Option(help="Jobs at the same time [LOA_WORKERS].")] = None,
    processes: Annotated[
        int | None, typer.Option(help="Processes that answer requests [LOA_PROCESSES].")
    ] = None,
    no_work: Annotated[
        bool, typer.Option("--no-work", help="Serve only; loa work runs the jobs of the same database.")
    ] = False,
) -> None:
    """Serve jobs and results over HTTP on this machine, until stopped."""
    from lineofaction.cli.serve import run_serve  # noqa: PLC0415 (start-up time)

    settings = {"host": host, "port": port, "data_directory": data_directory}
    run_serve(**settings, workers=workers, processes=processes, works=not no_work)


@verbs.command(epilog="Example: LOA_DATABASE_URL=postgresql://loa@db/loa loa work --workers 4")
@guarded
def work(
    data_directory: Annotated[
        Path | None, typer.Option(help="Directory of workspaces, one per loa work [LOA_DATA_DIRECTORY].")
    ] = None,
    workers: Annotated[int | None, typer.Option(help="Jobs at the same time [LOA_WORKERS].")] = None,
) -> None:
    """Run the jobs of a database that loa serve --no-work fills, until stopped."""
    from lineofaction.cli.work import run_work  # noqa: PLC0415 (start-up time)

    run_work(data_directory=data_directory, workers=workers)


@dataclass(frozen=True)
class TermOptions:
    """The terms of a job."""

    title: Annotated[str, typer.Option(help="Name of the job in lists.")] = ""
    tag: Annotated[list[str] | None, typer.Option(help="Tag of the job; may be repeated.")] = None
    priority: Annotated[int, typer.Option(help="-9 to 9; the highest is next.")] = 0
    max_cost_s: Annotated[
        float | None, typer.Option("--max-cost", help="CPU seconds that the job may take; default: no limit.")
    ] = None

    @property
    def as_sent(self) -> dict[str, Any]:
        """Return them as the client takes them."""
        limits = {"priority": self.priority, "max_cost_s": self.max_cost_s}
        return {"title": self.title, "tags": tuple(self.tag or ()), **limits}


@verbs.command(epilog="Example: loa submit examples/palermo_spur_20_20.toml --wait -o ste.nc")
@computing
@overridable("file", "case or scene")
@grouped
def submit(
    *,
    file: Annotated[InputFile, file_argument("Case or scene file", "FILE")],
    service: Service = DEFAULT_SERVICE,
    wait: Annotated[bool, typer.Option("--wait", help="Wait for the result.")] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Wait for the result and write it to this file.")
    ] = None,
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
    terms: TermOptions,
    json: AsJson = False,
) -> None:
    """Submit a case or a scene to a service."""
    from lineofaction.cli.remote import ProcessRequest, run_submit  # noqa: PLC0415 (start-up time)

    request = ProcessRequest(process, inputs, terms.as_sent)
    run_submit(file, service, request, wait=wait, output=output, as_json=json)


@verbs.command(epilog="Example: loa fetch 3f1c0e5a-6c3d-4c1e-9b1e-2f6f0a1b2c3d -o ste.nc")
@computing
def fetch(
    name: Annotated[str, typer.Argument(help="Identifier of a job, or content hash of a result.")],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", help="File to write: netCDF or JSON, by its kind."),
    ],
    service: Service = DEFAULT_SERVICE,
    wait: Annotated[bool, typer.Option("--wait", help="Wait for the job.")] = False,
    json: AsJson = False,
) -> None:
    """Fetch the result of a job, or a result by its hash, from a service or the cache."""
    from lineofaction.cli.remote import run_fetch  # noqa: PLC0415 (start-up time)

    run_fetch(name, output, service, wait=wait, as_json=json)
