"""Verbs on one gear pair: its table, curves, and files for other programs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from lineofaction.cli.guard import computing
from lineofaction.cli.signature import grouped
from lineofaction.cli.verbs.options import AsJson, DaskScheduler, Force, LoadPoint, TaskWorkers
from lineofaction.cli.verbs.overrides import CaseFile, file_argument, overridable
from lineofaction.gearbox.input_file import InputFile

verbs = typer.Typer()


@verbs.command(epilog="Example: loa analyze examples/palermo_spur_20_20.toml -o ste.nc")
@computing
@overridable("case")
def analyze(
    case: CaseFile,
    output: Annotated[Path, typer.Option("-o", "--output", help="STE database to write (netCDF).")],
    workers: TaskWorkers = 1,
    dask: DaskScheduler = None,
    json: AsJson = False,
) -> None:
    """Compute the STE database of a case."""
    from lineofaction.cli.analyze import run_analyze  # noqa: PLC0415 (start-up time)
    from lineofaction.gearbox.convert.task_workers import ExecutorChoice  # noqa: PLC0415

    run_analyze(case, output, ExecutorChoice(workers, dask), as_json=json)


@verbs.command(epilog="Example: loa geometry examples/sensitivity_automotive.toml -o pair.html")
@computing
@overridable("case")
def geometry(
    case: CaseFile,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Drawing or page to write, ending in .html, .png or .svg."),
    ] = None,
    json: AsJson = False,
) -> None:
    """Print the data sheet of a pair (ISO 21771-1), and draw its mesh and its flank modifications."""
    from lineofaction.cli.geometry import run_geometry  # noqa: PLC0415 (start-up time)

    run_geometry(case, output, as_json=json)


@verbs.command(epilog="Example: loa ste ste.nc --torque 100 --at 0,0.25,0.5")
@computing
def ste(
    database: Annotated[Path, typer.Argument(help="STE database (netCDF).")],
    torque: Annotated[float | None, typer.Option(help="Torque on the driving gear in N m.")] = None,
    force: Force = None,
    at: Annotated[
        str | None,
        typer.Option(help="Positions of the driving gear in base pitches, 0 = pitch point: 0,0.25,0.5"),
    ] = None,
    misalignment_um: Annotated[float | None, typer.Option(help="Misalignment in um.")] = None,
    center_distance_change_mm: Annotated[
        float | None, typer.Option(help="Change of the center distance in mm.")
    ] = None,
    csv: Annotated[bool, typer.Option("--csv", help="Print CSV.")] = False,
    json: AsJson = False,
) -> None:
    """Print one STE curve of a database, with load sharing, mean, peak-to-peak and harmonics."""
    from lineofaction.cli.ste import CurveRequest, run_ste  # noqa: PLC0415 (start-up time)

    request = CurveRequest(torque, force, at, misalignment_um, center_distance_change_mm)
    run_ste(database, request, as_csv=csv, as_json=json)


@dataclass(frozen=True)
class FmuOptions:
    """Start values of an exported FMU."""

    damping_n_s_per_m: Annotated[
        float, typer.Option(help="Start value of an FMU's mesh damping along the line of action in N s/m.")
    ] = 0.0
    backlash_um: Annotated[
        float | None,
        typer.Option(help="Backlash of an FMU with coast flanks, along the transverse line of action in um."),
    ] = None


@dataclass(frozen=True)
class RunPart:
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


@verbs.command(epilog="Example: loa export examples/palermo_spur_20_20.toml --torque 100 -o deformed")
@computing
@overridable("case")
@grouped
def export(
    *,
    case: Annotated[
        InputFile,
        file_argument("Case file; STE database for an FMU; a run; with --rexs a table or deflection", "CASE"),
    ],
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            help="Folder for pinion.vtu and wheel.vtu, or MESH.fmu; for a run .unv or .csv; "
            "with --rexs .rexs, .rexsj or .rexsz.",
        ),
    ],
    point: LoadPoint,
    at: Annotated[str, typer.Option(help="Positions of the driving gear in base pitches.")] = "0",
    beside: Annotated[
        int, typer.Option(min=0, max=100, help="Unloaded teeth to show on either side, in three dimensions.")
    ] = 1,
    rexs: Annotated[
        Path | None,
        typer.Option(help="REXS file of the unit to which the results are added."),
    ] = None,
    fmu: FmuOptions,
    part: RunPart,
    json: AsJson = False,
) -> None:
    """Write gears as they bend in mesh, the mesh force as FMU, results into REXS, a run as UFF or CSV."""
    from lineofaction.cli.export import run_export  # noqa: PLC0415 (start-up time)
    from lineofaction.cli.export_fmu import run_export_fmu  # noqa: PLC0415
    from lineofaction.cli.export_rexs import run_export_rexs  # noqa: PLC0415
    from lineofaction.cli.export_run import is_for_runs, run_export_run  # noqa: PLC0415

    if rexs is not None:
        run_export_rexs(case.as_it_is, rexs, output, point.inputs, as_json=json)
    elif is_for_runs(output):
        run_export_run(case.as_it_is, output, part.function, (part.start, part.end), as_json=json)
    elif output.suffix == ".fmu":
        facts = point.inputs, fmu.damping_n_s_per_m, fmu.backlash_um
        run_export_fmu(case.as_it_is, output, *facts, as_json=json)
    else:
        run_export(case, output, point.inputs, at, beside, as_json=json)
