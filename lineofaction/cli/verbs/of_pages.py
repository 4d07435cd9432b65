"""Arguments, help and examples of the verbs that write pages."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lineofaction.cli.guard import computing
from lineofaction.cli.options import AsJson, to_file
from lineofaction.cli.verb_parameters import grouped
from lineofaction.cli.verbs import Later
from lineofaction.gearbox.number_list import number_list

if TYPE_CHECKING:
    from lineofaction.cli import compare, pages
    from lineofaction.report.comparison import recorded as recordings
    from lineofaction.report.run import view as views
else:
    compare, pages = Later("cli.compare"), Later("cli.pages")
    views = Later("report.run.view")
    recordings = Later("report.comparison.recorded")

verbs = typer.Typer()


@dataclass(frozen=True)
class _ViewOptions:
    """Options that choose the part of a run that a page shows."""

    quantity: Annotated[
        str,
        typer.Option(
            help="Quantity of a run to show: force, moment, acceleration, mesh_force, elastic_force, "
            "transmission_error.",
            show_default="force",
        ),
    ] = ""
    bearing: Annotated[str, typer.Option(help="Bearing of a run to show.", show_default="the loudest")] = ""
    mesh: Annotated[
        str,
        typer.Option(
            help="Mesh of a run whose orders are shown, or of a scene, whose flanks are compared.",
            show_default="the first, the only one",
        ),
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
    def view(self) -> views.RunView:
        """The view that the options name."""
        cuts = tuple(number_list("--orders", self.orders)) if self.orders else ()
        return views.RunView(**{**asdict(self), "orders": cuts})


@verbs.command("report", rich_help_panel="results", epilog="Example: loa report ste.nc run.nc -o report.html")
@computing
@grouped
def _report(
    *,
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Result files, netCDF or JSON: STE database, flank results, studies, run; one of each kind. "
            "Of a folder all that are in it."
        ),
    ],
    output: Annotated[
        Path | None, to_file("Page to write, .html or .pdf; default: report.html, here or in the folder.")
    ] = None,
    images: Annotated[Path | None, typer.Option(help="Folder to write the plots to as PNG.")] = None,
    about: Annotated[
        Path | None,
        typer.Option(help="File with a table [report]: the title block.", show_default="of the folder"),
    ] = None,
    still: Annotated[
        bool, typer.Option("--still", help="Pictures in place of plots to work with: a fifth of the bytes.")
    ] = False,
    flank: Annotated[
        bool,
        typer.Option("--flank", help="Compute the flank results at the load of the page."),
    ] = False,
    view: _ViewOptions,
    json: AsJson = False,
) -> None:
    """Write one page or PDF with the plots of a database, flank results, studies or a run."""
    options = pages.ReportOptions(images, about, still)
    pages.run_report(files, output, options, view.view, flank=flank, as_json=json)


@dataclass(frozen=True)
class _RecordingOptions:
    """Options that complete the file of a recording."""

    channel: Annotated[
        str, typer.Option(help="Channel of a recording that is compared.", show_default="the only one")
    ] = ""
    unit: Annotated[
        str,
        typer.Option(help="Unit of that channel of a recording, as m/s² or g.", show_default="the file's"),
    ] = ""
    full_scale: Annotated[
        float, typer.Option(help="Value, in the unit, of 1 in a recording's file; of WAV: the full scale.")
    ] = 1.0
    tacho: Annotated[
        str, typer.Option(help="Channel of the speed or tacho of a recording.", show_default="the only one")
    ] = ""
    tacho_unit: Annotated[
        str, typer.Option(help="Unit of the speed of a recording, as rpm.", show_default="the file's")
    ] = ""
    pulses_per_turn: Annotated[
        float, typer.Option(help="Pulses per turn of a recording's tacho; 0: the channel is a speed.")
    ] = 0.0
    rpm: Annotated[
        float, typer.Option(help="Constant speed of a recording without a tacho, rpm; 0: it has a tacho.")
    ] = 0.0
    ratio: Annotated[
        float, typer.Option(help="Speed of the driving gear over that of a recording's shaft.")
    ] = 1.0


@dataclass(frozen=True)
class _ChangeOptions:
    """Options of a comparison of two flanks in a scene: tolerances, load cases, speeds, required level."""

    scene: Annotated[
        Path | None, typer.Option(help="Scene file in which the sounds of two flanks are compared.")
    ] = None
    tolerances: Annotated[
        Path | None,
        typer.Option(help="File with the tolerances of the flanks, the options of loa scatter (TOML)."),
    ] = None
    load_cases: Annotated[
        Path | None, typer.Option(help="File with [[load_cases]] of the scene (TOML), as for loa deflect.")
    ] = None
    speed_rpm: Annotated[
        str | None, typer.Option(help="Speeds of the scene in rpm, FIRST:LAST:STEP or a list.")
    ] = None
    requirement_db: Annotated[
        float | None, typer.Option(help="Highest level of all orders that 95 % of the pairs may have.")
    ] = None

    def question(self, scene: Path, mesh: str) -> compare.FlankQuestion:
        """Return the question of a change of flanks of a mesh in a scene."""
        return compare.FlankQuestion(
            scene, mesh or None, self.tolerances, self.load_cases, self.speed_rpm, self.requirement_db
        )


@verbs.command(
    "compare",
    rich_help_panel="design",
    epilog="Example: loa compare before.nc after.nc measured.csv -o comparison.html",
)
@computing
@grouped
def _compare(
    *,
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Two STE databases, two runs, or one of them and a measurement (CSV, UFF; beside a run "
            "also WAV, MAT, HDF5, MDF4); two folders: the "
            "databases and runs that both have by name; with --scene the case files of the flanks before and "
            "after, or after alone: before are the scene's."
        ),
    ],
    output: Annotated[Path, to_file("Page to write.")] = Path("comparison.html"),
    torque: Annotated[
        float | None,
        typer.Option(help="Torque of the ripples shown, N m.", show_default="the middle one"),
    ] = None,
    change: _ChangeOptions,
    view: _ViewOptions,
    recorded: _RecordingOptions,
    json: AsJson = False,
) -> None:
    """Compare two tables, two runs, two flanks in a scene, or one with a measurement: differences."""
    if change.scene is not None:
        compare.run_compare_flanks(files, change.question(change.scene, view.mesh), output, as_json=json)
        return
    measurement = recordings.Measurement(**asdict(recorded))
    compare.run_compare(files, output, view.view, (torque, measurement), as_json=json)
