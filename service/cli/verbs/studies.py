"""Verbs on what results are worth that are no rows of the registry: plans, sensitivity, hard scenes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli.guard import computing, guarded
from service.cli.verbs.options import AsJson, DaskScheduler, TaskWorkers

verbs = typer.Typer()


@verbs.command(epilog="Example: loa plan examples/palermo_spur_20_20.toml --time-budget-s 5")
@computing
def plan(
    case: Annotated[Path, typer.Argument(help="Case file.")],
    time_budget_s: Annotated[
        float | None, typer.Option(help="CPU seconds to hold the plan against, beside the case's tolerance.")
    ] = None,
    json: AsJson = False,
) -> None:
    """Predict time by stage, memory and error of a case, with its effects; computes no contact."""
    from service.cli.plan import run_plan  # noqa: PLC0415 (start-up time)

    run_plan(case, time_budget_s, as_json=json)


@verbs.command(epilog="Example: loa sensitivity examples/sensitivity_wind_turbine.toml -o sensitivity")
@computing
def sensitivity(
    cases: Annotated[list[Path], typer.Argument(help="Case files; each becomes a line in the picture.")],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", help="Folder, or a file ending in .png, .csv, .json, .nc, .html."),
    ],
    misalignment_um: Annotated[str, typer.Option(help="Misalignments in um.")] = "0,15,30,45,60",
    center_distance_change_percent: Annotated[
        str, typer.Option(help="Changes of the center distance in per cent.")
    ] = "-0.2,-0.1,0,0.1,0.2",
    workers: TaskWorkers = 1,
    dask: DaskScheduler = None,
    json: AsJson = False,
) -> None:
    """Vary misalignment and center distance of a case at its highest load: peak-to-peak STE."""
    from service.cli.sensitivity import Varied, run_sensitivity  # noqa: PLC0415 (start-up time)
    from service.convert.task_workers import ExecutorChoice  # noqa: PLC0415

    varied = Varied(misalignment_um, center_distance_change_percent)
    run_sensitivity(cases, output, varied, ExecutorChoice(workers, dask), as_json=json)


@verbs.command(epilog="Example: loa hardcases --only table -o hardcases.html")
@guarded
def hardcases(
    only: Annotated[
        list[str] | None, typer.Option("--only", help="Names or families of scenes, separated by commas.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Report page to write (HTML).")
    ] = None,
    json: AsJson = False,
) -> None:
    """Run the hard scenes: cases known to break solvers, each assessed by laws of physics."""
    from service.cli.hardcases import run_hardcases  # noqa: PLC0415 (start-up time)

    run_hardcases(only or [], output, as_json=json)
