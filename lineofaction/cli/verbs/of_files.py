"""Arguments, help and examples of the verbs on files: first files, tables, runs, pages, plans."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lineofaction.cli.guard import computing, grouped, guarded
from lineofaction.cli.options import (
    AsJson,
    CaseFile,
    Force,
    PairWishes,
    SceneFile,
    Scheduler,
    TableService,
    TaskWorkers,
    file_argument,
    overridable,
    to_file,
)
from lineofaction.cli.verbs import Later
from lineofaction.gearbox.input_file import InputFile, number_list

if TYPE_CHECKING:
    from lineofaction.cli import analyze, export, hardcases, listen, new, pages, simulate, status, ste
    from lineofaction.report.comparison import recorded as recordings
    from lineofaction.report.run import view as views
else:
    analyze, export, hardcases, listen = map(
        Later, ("cli.analyze", "cli.export", "cli.hardcases", "cli.listen")
    )
    new, pages, simulate, status, ste = map(
        Later, ("cli.new", "cli.pages", "cli.simulate", "cli.status", "cli.ste")
    )
    views = Later("report.run.view")
    recordings = Later("report.comparison.recorded")

verbs = typer.Typer()


@verbs.command(
    "new",
    rich_help_panel="start",
    epilog="Example: loa new --helical --module 1.8 --teeth 23 --ratio 2.9 -o pair.toml",
)
@guarded
@grouped
def _new(
    *,
    spur: Annotated[bool, typer.Option("--spur", help="A spur pair.")] = False,
    helical: Annotated[bool, typer.Option("--helical", help="A helical pair (default).")] = False,
    internal: Annotated[bool, typer.Option("--internal", help="A pinion in a ring gear.")] = False,
    planetary: Annotated[bool, typer.Option("--planetary", help="A planetary stage, as a scene.")] = False,
    scene: Annotated[bool, typer.Option("--scene", help="A helical pair between shafts.")] = False,
    wanted: PairWishes,
    output: Annotated[Path | None, to_file("New file to write (TOML); default: print it.")] = None,
) -> None:
    """Write a first case or scene file; rules set all data that are not given."""
    kinds = {"spur": spur, "helical": helical, "internal": internal, "planetary": planetary, "scene": scene}
    new.run_new(kinds, wanted, output)


# Verbs on one gear pair: its table, curves, and files for other programs.


@verbs.command("status", rich_help_panel="start", epilog="Example: loa status gearbox")
@computing
def _status(
    folder: Annotated[Path, typer.Argument(help="Folder that loa open made, or with a case or scene file.")],
    json: AsJson = False,
) -> None:
    """Say which results of a folder are fresh, stale or missing, which verb makes them, and what it costs."""
    status.run_status(folder, as_json=json)


@verbs.command(
    "analyze",
    rich_help_panel="pair",
    epilog="Example: loa analyze examples/palermo_spur_20_20.toml -o ste.nc",
)
@computing
@overridable("case")
def _analyze(
    case: CaseFile,
    output: Annotated[Path | None, to_file("STE database to write (netCDF).")] = None,
    workers: TaskWorkers = 1,
    scheduler: Scheduler = None,
    json: AsJson = False,
) -> None:
    """Compute the STE database of a case."""
    analyze.run_analyze(case, output, (workers, scheduler), as_json=json)


@verbs.command(
    "geometry",
    rich_help_panel="start",
    epilog="Example: loa geometry examples/sensitivity_automotive.toml -o pair.html",
)
@computing
@overridable("case")
def _geometry(
    case: CaseFile,
    output: Annotated[
        Path | None,
        to_file("Drawing or page to write, ending in .html, .png or .svg."),
    ] = None,
    json: AsJson = False,
) -> None:
    """Print the data sheet of a pair (ISO 21771-1), and draw its mesh and its flank modifications."""
    pages.run_geometry(case, output, as_json=json)


@verbs.command("ste", rich_help_panel="pair", epilog="Example: loa ste ste.nc --torque 100 --at 0,0.25,0.5")
@computing
def _ste(
    database: Annotated[Path, typer.Argument(help="STE database (netCDF), or the folder of tables.")],
    torque: Annotated[float | None, typer.Option(help="On the driving gear, N m; default: highest.")] = None,
    force: Force = None,
    at: Annotated[
        str | None,
        typer.Option(help="Positions of the driving gear in base pitches, 0 = pitch point: 0,0.25,0.5"),
    ] = None,
    misalignment_um: Annotated[float | None, typer.Option(help="Misalignment in µm.")] = None,
    center_distance_change_mm: Annotated[
        float | None, typer.Option(help="Change of the center distance in mm.")
    ] = None,
    table: Annotated[bool, typer.Option("--table", help="Print every position of the curve.")] = False,
    csv: Annotated[bool, typer.Option("--csv", help="Print CSV.")] = False,
    json: AsJson = False,
) -> None:
    """Print one STE curve of a database: mean, peak-to-peak, harmonics with their errors, load sharing."""
    place = {"misalignment_um": misalignment_um, "center_distance_change_mm": center_distance_change_mm}
    point = {"torque": torque, "force": force, **place}
    ste.run_ste(database, point, at, as_table=table, as_csv=csv, as_json=json)


@dataclass(frozen=True)
class _LoadPoint:
    """One load and alignment."""

    torque_n_m: Annotated[
        float | None,
        typer.Option("--torque", help="Torque on the driving gear in N m; default: the highest load."),
    ] = None
    normal_force_n: Force = None
    misalignment_um: Annotated[
        float | None, typer.Option(help="Misalignment in µm; default: the value of the case nearest to 0.")
    ] = None
    center_distance_change_mm: Annotated[
        float | None,
        typer.Option(help="Change of the center distance in mm; default: the value nearest to 0."),
    ] = None


@dataclass(frozen=True)
class _FmuOptions:
    """Start values of an exported FMU."""

    damping_n_s_per_m: Annotated[
        float, typer.Option(help="Start value of an FMU's mesh damping along the line of action in N s/m.")
    ] = 0.0
    backlash_um: Annotated[
        float | None,
        typer.Option(help="Backlash of an FMU with coast flanks, along the transverse line of action in µm."),
    ] = None


@dataclass(frozen=True)
class _RunPart:
    """What of a run is exported."""

    function: Annotated[
        str,
        typer.Option(
            help="Exported from a run: time, spectrum (over frequency) or orders (over mesh orders)."
        ),
    ] = "time"
    start: Annotated[
        float | None, typer.Option("--from", help="Start time of the exported part of a run in s.")
    ] = None
    end: Annotated[
        float | None, typer.Option("--to", help="End time of the exported part of a run in s.")
    ] = None


@verbs.command(
    "export",
    rich_help_panel="results",
    epilog="Example: loa export examples/palermo_spur_20_20.toml --torque 100 -o deformed",
)
@computing
@overridable("case")
@grouped
def _export(
    *,
    case: Annotated[
        InputFile,
        file_argument("Case file; STE database for an FMU; a run; with --rexs a table or deflection", "CASE"),
    ],
    output: Annotated[
        Path,
        to_file(
            "Folder for pinion.vtu and wheel.vtu, or MESH.fmu; for a run .unv or .csv; "
            "with --rexs .rexs, .rexsj or .rexsz."
        ),
    ],
    point: _LoadPoint,
    at: Annotated[str, typer.Option(help="Positions of the driving gear in base pitches.")] = "0",
    beside: Annotated[
        int, typer.Option(min=0, max=100, help="Unloaded teeth to show on either side, in three dimensions.")
    ] = 1,
    rexs: Annotated[
        Path | None,
        typer.Option(help="REXS file of the unit to which the results are added."),
    ] = None,
    fmu: _FmuOptions,
    part: _RunPart,
    json: AsJson = False,
) -> None:
    """Write gears as they bend in mesh, the mesh force as FMU, results into REXS, a run as UFF or CSV."""
    further = asdict(fmu) | asdict(part)
    export.run_export(case, output, asdict(point), rexs, at=at, beside=beside, as_json=json, **further)


# Verbs on scenes that are no studies: runs.


@dataclass(frozen=True)
class _HeardOptions:
    """What of a run is heard."""

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


@verbs.command(
    "simulate",
    rich_help_panel="gearbox",
    epilog="Example: loa simulate examples/palermo_scene.toml -o run.nc",
)
@computing
@overridable("scene", "scene")
def _simulate(
    scene: SceneFile,
    output: Annotated[Path | None, to_file("Run to write (netCDF).")] = None,
    workers: TaskWorkers = 1,
    scheduler: Scheduler = None,
    service: TableService = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue a run that was interrupted or killed.")
    ] = False,
    json: AsJson = False,
) -> None:
    """Run the dynamics of a scene; Ctrl-C stops it, stores the results so far, and --resume continues."""
    simulate.run_simulate(scene, output, (workers, scheduler), service, resume=resume, as_json=json)


@verbs.command("listen", rich_help_panel="sound", epilog="Example: loa listen before.nc after.nc -o sounds")
@computing
@grouped
def _listen(
    *,
    runs: Annotated[list[Path], typer.Argument(help="Runs (netCDF), or a folder; all on one full scale.")],
    output: Annotated[
        Path | None, to_file("WAV file, or folder of one file per run; default: run.wav in the folder.")
    ] = None,
    heard: _HeardOptions,
    housing: _HousingOptions,
    json: AsJson = False,
) -> None:
    """Write runs as WAV files of stated quantity and level, to hear and to compare by ear."""
    listen.run_listen(runs, output, views.RunView(**asdict(heard)), **asdict(housing), as_json=json)


# Verbs on accuracy and robustness that are not studies of the registry: plans, hard scenes.


@verbs.command(
    "plan",
    rich_help_panel="pair",
    epilog="Example: loa plan examples/palermo_spur_20_20.toml --time-budget-s 5",
)
@computing
@overridable("case")
def _plan(
    case: CaseFile,
    time_budget_s: Annotated[
        float | None,
        typer.Option(help="Budget in CPU seconds to compare the plan with, besides the case's tolerance."),
    ] = None,
    json: AsJson = False,
) -> None:
    """Predict time by stage, memory and error of a case, with its effects; computes no contact."""
    analyze.run_plan(case, time_budget_s, as_json=json)


@verbs.command(
    "hardcases", rich_help_panel="trust", epilog="Example: loa hardcases --only table -o hardcases.html"
)
@guarded
def _hardcases(
    only: Annotated[
        list[str] | None, typer.Option("--only", help="Names or families of scenes, separated by commas.")
    ] = None,
    output: Annotated[Path | None, to_file("Report page to write (HTML).")] = None,
    json: AsJson = False,
) -> None:
    """Run the hard scenes: cases known to break solvers, each checked against laws of physics."""
    hardcases.run_hardcases(only or [], output, as_json=json)


# The verbs that write pages.


@dataclass(frozen=True)
class _ViewOptions:
    """What of a run is shown."""

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
    """What the file of a recording does not say."""

    channel: Annotated[
        str, typer.Option(help="Of a recording: the channel that is compared.", show_default="the only one")
    ] = ""
    unit: Annotated[
        str,
        typer.Option(help="Of a recording: unit of that channel, as m/s² or g.", show_default="the file's"),
    ] = ""
    full_scale: Annotated[
        float, typer.Option(help="Of a recording: what 1 in the file is in the unit; of WAV: the full scale.")
    ] = 1.0
    tacho: Annotated[
        str, typer.Option(help="Of a recording: channel of the speed or tacho.", show_default="the only one")
    ] = ""
    tacho_unit: Annotated[
        str, typer.Option(help="Of a recording: unit of the speed, as rpm.", show_default="the file's")
    ] = ""
    pulses_per_turn: Annotated[
        float, typer.Option(help="Of a recording: the tacho is so many pulses a turn; 0: a speed.")
    ] = 0.0
    rpm: Annotated[
        float, typer.Option(help="Of a recording without a tacho: its one speed, rpm; 0: there is a tacho.")
    ] = 0.0
    ratio: Annotated[
        float, typer.Option(help="Of a recording: speed of the driving gear over that of the recorded shaft.")
    ] = 1.0


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
    scene: Annotated[
        Path | None, typer.Option(help="Scene file in which two flanks are heard: what a change brings.")
    ] = None,
    tolerances: Annotated[
        Path | None, typer.Option(help="Of the flanks: file with the options of loa scatter (TOML).")
    ] = None,
    load_cases: Annotated[
        Path | None, typer.Option(help="Of the scene: file with [[load_cases]] (TOML), as of loa deflect.")
    ] = None,
    speed_rpm: Annotated[
        str | None, typer.Option(help="Of the scene: speeds in rpm, FIRST:LAST:STEP or a list.")
    ] = None,
    requirement_db: Annotated[
        float | None, typer.Option(help="Highest level of all orders that 95 % of the pairs may have.")
    ] = None,
    view: _ViewOptions,
    recorded: _RecordingOptions,
    json: AsJson = False,
) -> None:
    """Compare two tables, two runs, two flanks in a scene, or one with a measurement: differences."""
    if scene is not None:
        question = pages.FlankQuestion(
            scene, view.mesh or None, tolerances, load_cases, speed_rpm, requirement_db
        )
        pages.run_compare_flanks(files, question, output, as_json=json)
        return
    measurement = recordings.Measurement(**asdict(recorded))
    pages.run_compare(files, output, view.view, (torque, measurement), as_json=json)
