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
    json: AsJson = False,
) -> None:
    """Write one HTML page with the plots of a database, flank results, studies or a run."""
    from service.cli.report import run_report  # noqa: PLC0415 (start-up time)

    run_report(files, output, images, flank=flank, as_json=json)
