"""Arguments, help and examples of the verbs on cases and scenes: first files, plans, tables, runs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lineofaction.cli.guard import computing, guarded
from lineofaction.cli.options import AsJson, Force, PairWishes, Scheduler, TableService, TaskWorkers, to_file
from lineofaction.cli.overrides import CaseFile, SceneFile, overridable
from lineofaction.cli.verb_parameters import grouped
from lineofaction.cli.verbs import Later

if TYPE_CHECKING:
    from lineofaction.cli import analyze, data_sheet, new, plan, simulate, status, ste
else:
    analyze, data_sheet, new, plan, simulate, status, ste = map(
        Later,
        ("cli.analyze", "cli.data_sheet", "cli.new", "cli.plan", "cli.simulate", "cli.status", "cli.ste"),
    )

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
    data_sheet.run_geometry(case, output, as_json=json)


@verbs.command("ste", rich_help_panel="pair", epilog="Example: loa ste ste.nc --torque 100 --at 0,0.25,0.5")
@computing
def _ste(
    database: Annotated[Path, typer.Argument(help="STE database (netCDF), or the folder of tables.")],
    torque: Annotated[
        float | None, typer.Option(help="Torque on the driving gear, N m; default: the highest.")
    ] = None,
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
    alignment = {"misalignment_um": misalignment_um, "center_distance_change_mm": center_distance_change_mm}
    point = {"torque": torque, "force": force, **alignment}
    ste.run_ste(database, point, at, as_table=table, as_csv=csv, as_json=json)


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
    plan.run_plan(case, time_budget_s, as_json=json)
