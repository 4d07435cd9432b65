"""Verbs on scenes that are no studies: runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli.guard import computing
from service.cli.verbs.options import AsJson, TableService
from service.cli.verbs.overrides import SceneFile, overridable

verbs = typer.Typer()


@verbs.command(epilog="Example: loa simulate examples/palermo_scene.toml -o run.nc")
@computing
@overridable("scene", "scene")
def simulate(
    scene: SceneFile,
    output: Annotated[Path, typer.Option("-o", "--output", help="Run to write (netCDF).")],
    service: TableService = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue a run that was interrupted or killed.")
    ] = False,
    json: AsJson = False,
) -> None:
    """Run the dynamics of a scene; Ctrl-C stops it, stores the results so far, and --resume continues."""
    from service.cli.simulate import run_simulate  # noqa: PLC0415 (start-up time)

    run_simulate(scene, output, service, resume=resume, as_json=json)
