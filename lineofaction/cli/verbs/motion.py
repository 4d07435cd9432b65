"""Verbs on scenes that are no studies: runs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lineofaction.cli.guard import computing
from lineofaction.cli.signature import grouped
from lineofaction.cli.verbs.options import AsJson, TableService
from lineofaction.cli.verbs.overrides import SceneFile, overridable

if TYPE_CHECKING:
    from lineofaction.cli.listen_through_housing import HousingReceiver
    from lineofaction.report.runs.run_view import RunView

verbs = typer.Typer()


@dataclass(frozen=True)
class HeardOptions:
    """What of a run is heard."""

    quantity: Annotated[
        str,
        typer.Option(
            help="Quantity to hear: force, moment, acceleration, mesh_force, transmission_error.",
            show_default="force",
        ),
    ] = ""
    bearing: Annotated[str, typer.Option(help="Bearing to hear.", show_default="the loudest")] = ""
    mesh: Annotated[
        str, typer.Option(help="Mesh to hear, or whose orders are listed.", show_default="the first")
    ] = ""
    direction: Annotated[
        str,
        typer.Option(
            help="Direction at the bearing or point: x, y, z or principal.",
            show_default="in which it varies most",
        ),
    ] = ""

    @property
    def view(self) -> RunView:
        """The view that the options name."""
        from lineofaction.report.runs.run_view import RunView  # noqa: PLC0415 (start-up time)

        return RunView(self.quantity, self.bearing, self.mesh, direction=self.direction)


@dataclass(frozen=True)
class HousingOptions:
    """Where a run is heard through the housings of a scene."""

    scene: Annotated[
        Path | None,
        typer.Option(help="Scene file whose housings the forces on bearings move.", show_default="none"),
    ] = None
    point: Annotated[
        str, typer.Option(help="Point of a housing whose velocity is heard.", show_default="none")
    ] = ""
    microphone: Annotated[
        str,
        typer.Option(
            metavar="X,Y,Z",
            help="Where the sound pressure is heard, in mm in the frame of the scene: free field.",
            show_default="none",
        ),
    ] = ""

    @property
    def receiver(self) -> HousingReceiver | None:
        """What the options name."""
        from lineofaction.cli.listen_through_housing import housing_receiver  # noqa: PLC0415 (start-up time)

        return housing_receiver(self.scene, self.point, self.microphone)


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
    from lineofaction.cli.simulate import run_simulate  # noqa: PLC0415 (start-up time)

    run_simulate(scene, output, service, resume=resume, as_json=json)


@verbs.command(epilog="Example: loa listen before.nc after.nc -o sounds")
@computing
@grouped
def listen(
    *,
    runs: Annotated[list[Path], typer.Argument(help="Runs (netCDF); several are written on one full scale.")],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", help="WAV file, or folder of one file per run, named as the run."),
    ],
    heard: HeardOptions,
    housing: HousingOptions,
    json: AsJson = False,
) -> None:
    """Write runs as WAV files of stated quantity and level, to hear and to compare by ear."""
    from lineofaction.cli.listen import run_listen  # noqa: PLC0415 (start-up time)

    run_listen(runs, output, heard.view, housing.receiver, as_json=json)
