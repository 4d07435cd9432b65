"""The verb that writes pages."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli.guard import computing
from service.cli.verbs.options import AsJson

verbs = typer.Typer()


@verbs.command(epilog="Example: loa report ste.nc run.nc -o report.html")
@computing
def report(
    files: Annotated[
        list[Path],
        typer.Argument(help="STE database, flank results, studies, run, netCDF or JSON; one of each kind."),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="Page to write.")] = Path("report.html"),
    images: Annotated[Path | None, typer.Option(help="Folder to write the plots to as PNG.")] = None,
    flank: Annotated[
        bool,
        typer.Option("--flank", help="Compute what happens on the flanks at the load the page names."),
    ] = False,
    quantity: Annotated[
        str,
        typer.Option(
            help="What of a run is shown: force, moment, acceleration, mesh_force, transmission_error.",
            show_default="force",
        ),
    ] = "",
    bearing: Annotated[
        str, typer.Option(help="Bearing of a run that is shown.", show_default="the loudest")
    ] = "",
    mesh: Annotated[
        str, typer.Option(help="Mesh of a run whose orders are shown.", show_default="the first")
    ] = "",
    orders: Annotated[
        str, typer.Option(help="Mesh orders over speed, as 1,2,4 or 1:8:1.", show_default="the five largest")
    ] = "",
    window: Annotated[
        str, typer.Option(help="Window of the spectra of a run: hann, flat_top, rectangular.")
    ] = "hann",
    scale: Annotated[str, typer.Option(help="Amplitudes of a run: rms or peak.")] = "rms",
    json: AsJson = False,
) -> None:
    """Write one HTML page with the plots of a database, flank results, studies or a run."""
    from service.cli.number_list import number_list  # noqa: PLC0415 (start-up time)
    from service.cli.report import run_report  # noqa: PLC0415 (start-up time)
    from service.runs.run_view import RunView  # noqa: PLC0415 (start-up time)

    cuts = tuple(number_list("--orders", orders)) if orders else ()
    view = RunView(quantity, bearing, mesh, cuts, window, scale)
    run_report(files, output, images, view, flank=flank, as_json=json)
