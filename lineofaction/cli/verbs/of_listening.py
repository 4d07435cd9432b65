"""Arguments, help and example of the verb that writes sounds."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lineofaction.cli.guard import computing
from lineofaction.cli.options import AsJson, to_file
from lineofaction.cli.verb_parameters import grouped
from lineofaction.cli.verbs import Later

if TYPE_CHECKING:
    from lineofaction.cli import listen
    from lineofaction.report.run import view as views
else:
    listen = Later("cli.listen")
    views = Later("report.run.view")

verbs = typer.Typer()


@dataclass(frozen=True)
class _HeardOptions:
    """Options that choose the quantity of a run that is heard."""

    quantity: Annotated[
        str,
        typer.Option(
            help="Quantity to hear: force, moment, acceleration, mesh_force, elastic_force, "
            "transmission_error.",
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


@dataclass(frozen=True)
class _HousingOptions:
    """Options that choose the point or microphone at which a scene's housings are heard."""

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
            help="Microphone of the sound pressure in a free field, in mm in the frame of the scene.",
            show_default="none",
        ),
    ] = ""


@verbs.command("listen", rich_help_panel="sound", epilog="Example: loa listen before.nc after.nc -o sounds")
@computing
@grouped
def _listen(
    *,
    runs: Annotated[list[Path], typer.Argument(help="Runs (netCDF), or a folder; all on one full scale.")],
    output: Annotated[
        Path | None, to_file("WAV file, or folder of one file per run; default: run.wav in the folder.")
    ] = None,
    options: _HeardOptions,
    housing: _HousingOptions,
    json: AsJson = False,
) -> None:
    """Write runs as WAV files of stated quantity and level, to hear and to compare by ear."""
    listen.run_listen(runs, output, views.RunView(**asdict(options)), **asdict(housing), as_json=json)
