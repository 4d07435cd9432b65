"""The verbs that write pages."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lineofaction.cli.guard import computing
from lineofaction.cli.signature import grouped
from lineofaction.cli.verbs.options import AsJson

if TYPE_CHECKING:
    from lineofaction.report.runs.run_view import RunView

verbs = typer.Typer()


@dataclass(frozen=True)
class ViewOptions:
    """What of a run is shown."""

    quantity: Annotated[
        str,
        typer.Option(
            help="Quantity of a run to show: force, moment, acceleration, mesh_force, transmission_error.",
            show_default="force",
        ),
    ] = ""
    bearing: Annotated[str, typer.Option(help="Bearing of a run to show.", show_default="the loudest")] = ""
    mesh: Annotated[
        str, typer.Option(help="Mesh of a run whose orders are shown.", show_default="the first")
    ] = ""
    orders: Annotated[
        str,
        typer.Option(help="Mesh orders over speed, as 1,2,4 or 1:8:1.", show_default="the five largest"),
    ] = ""
    window: Annotated[
        str, typer.Option(help="Window of the spectra of a run: hann, flat_top, rectangular.")
    ] = "hann"
    scale: Annotated[str, typer.Option(help="Amplitudes of a run: rms or peak.")] = "rms"
    direction: Annotated[
        str,
        typer.Option(
            help="Direction of a quantity of bearings: x, y, z, or principal, in which it varies most.",
            show_default="orders of all three in power",
        ),
    ] = ""

    @property
    def view(self) -> RunView:
        """The view that the options name."""
        from lineofaction.gearbox.schemas.number_list import number_list  # noqa: PLC0415 (start-up time)
        from lineofaction.report.runs.run_view import RunView  # noqa: PLC0415 (start-up time)

        cuts = tuple(number_list("--orders", self.orders)) if self.orders else ()
        return RunView(self.quantity, self.bearing, self.mesh, cuts, self.window, self.scale, self.direction)


@verbs.command(epilog="Example: loa report ste.nc run.nc -o report.html")
@computing
@grouped
def report(
    *,
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Result files, netCDF or JSON: STE database, flank results, studies, run; one of each kind."
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="Page to write.")] = Path("report.html"),
    images: Annotated[Path | None, typer.Option(help="Folder to write the plots to as PNG.")] = None,
    flank: Annotated[
        bool,
        typer.Option("--flank", help="Compute the flank results at the load of the page."),
    ] = False,
    view: ViewOptions,
    json: AsJson = False,
) -> None:
    """Write one HTML page with the plots of a database, flank results, studies or a run."""
    from lineofaction.cli.report import run_report  # noqa: PLC0415 (start-up time)

    run_report(files, output, images, view.view, flank=flank, as_json=json)


@verbs.command(epilog="Example: loa compare before.nc after.nc measured.csv -o comparison.html")
@computing
@grouped
def compare(
    *,
    files: Annotated[
        list[Path],
        typer.Argument(help="Two STE databases, two runs, or one of them and a measurement (CSV, UFF)."),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="Page to write.")] = Path("comparison.html"),
    torque: Annotated[
        float | None,
        typer.Option(help="Torque of the ripples shown, N m.", show_default="the middle one"),
    ] = None,
    view: ViewOptions,
    json: AsJson = False,
) -> None:
    """Compare two tables or two runs, or one with a measurement: differences with their errors."""
    from lineofaction.cli.compare import run_compare  # noqa: PLC0415 (start-up time)

    run_compare(files, output, view.view, torque, as_json=json)
