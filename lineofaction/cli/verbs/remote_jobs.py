"""Verbs of the jobs of a service."""

from __future__ import annotations

from typing import Annotated

import typer

from lineofaction.cli.guard import guarded
from lineofaction.cli.verbs.options import DEFAULT_SERVICE, AsJson, Service

verbs = typer.Typer()


@verbs.command(epilog="Example: loa jobs --status running")
@guarded
def jobs(
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
    from lineofaction.cli.remote_jobs import JobSelection, run_jobs  # noqa: PLC0415 (start-up time)

    run_jobs(service, JobSelection(process or (), status or (), limit), as_json=json)


@verbs.command(epilog="Example: loa dismiss 3f1c0e5a-6c3d-4c1e-9b1e-2f6f0a1b2c3d")
@guarded
def dismiss(
    job: Annotated[str, typer.Argument(help="Identifier of a job.")],
    service: Service = DEFAULT_SERVICE,
    json: AsJson = False,
) -> None:
    """Cancel a job of a service; its work ends unless other jobs share it."""
    from lineofaction.cli.remote_jobs import run_dismiss  # noqa: PLC0415 (start-up time)

    run_dismiss(job, service, as_json=json)
