"""Verbs on accuracy: plans, accuracy studies, effects toggled, sensitivity, hard scenes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

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


@verbs.command(epilog="Example: loa frontier examples/palermo_spur_20_20.toml -o frontier")
@computing
def frontier(
    file: Annotated[Path, typer.Argument(help="Case or scene file.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Folder, or a file ending in .png, .html, .json."),
    ] = None,
    rungs: Annotated[
        str | None, typer.Option(help="Rungs to run, separated by commas; default: all that are valid.")
    ] = None,
    full_contact: Annotated[
        int | None,
        typer.Option(
            help="Positions of a spur pair to run by full finite-element contact: about 3 CPU s each in "
            "plane strain, 70 or more where the case needs the face."
        ),
    ] = None,
    json: AsJson = False,
) -> None:
    """Run the ladder on a case (ISO 6336 to fine finite elements) or on a scene: error against time."""
    from service.cli.frontier import run_frontier  # noqa: PLC0415 (start-up time)

    run_frontier(file, output, rungs, full_contact, as_json=json)


@verbs.command(epilog="Example: loa ablate examples/palermo_spur_20_20.toml -o ablation.png")
@computing
def ablate(
    file: Annotated[Path, typer.Argument(help="Case or scene file.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="File to write, ending in .png, .json or .html.")
    ] = None,
    only: Annotated[
        str | None, typer.Option(help="Effects to toggle, separated by commas; default: all.")
    ] = None,
    json: AsJson = False,
) -> None:
    """Switch each effect of a case or a scene over: what it changes, what was estimated, what it costs."""
    from service.cli.ablate import run_ablate  # noqa: PLC0415 (start-up time)

    run_ablate(file, output, only, as_json=json)


@verbs.command(
    epilog="Example: loa optimise examples/palermo_spur_20_20.toml examples/optimise_tip_relief.toml -o best"
)
@computing
def optimise(
    case: Annotated[Path, typer.Argument(help="Case file; its modifications are the start.")],
    study: Annotated[Path, typer.Argument(help="File of variables, scatter, objective, limits, search.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Folder, or a file ending in .png, .html, .json, .toml."),
    ] = None,
    workers: TaskWorkers = 1,
    dask: DaskScheduler = None,
    json: AsJson = False,
) -> None:
    """Choose flank modifications for the least peak-to-peak STE over torques and scatter."""
    from service.cli.optimise import run_optimise  # noqa: PLC0415 (start-up time)
    from service.convert.task_workers import ExecutorChoice  # noqa: PLC0415

    run_optimise(case, study, output, ExecutorChoice(workers, dask), as_json=json)


@verbs.command(
    epilog="Example: loa scatter examples/sensitivity_automotive.toml --samples 400 -o scatter.png"
)
@computing
def scatter(
    case: Annotated[Path, typer.Argument(help="Case file; its modifications are the design.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="File to write, ending in .png, .html or .json.")
    ] = None,
    tolerance_class: Annotated[
        int, typer.Option("--class", min=1, max=11, help="Tolerance class of ISO 1328-1, both gears.")
    ] = 6,
    misalignment_um: Annotated[
        float, typer.Option(min=0.0, max=1000.0, help="Tolerance of the misalignment, +- um.")
    ] = 0.0,
    uniform: Annotated[
        bool, typer.Option("--uniform", help="Uniform within the tolerances; default: normal, cut at 3 s.")
    ] = False,
    samples: Annotated[int, typer.Option(min=2, max=1_000_000, help="Pairs to draw.")] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Equal seeds give equal results.")] = 0,
    workers: TaskWorkers = 1,
    dask: DaskScheduler = None,
    json: AsJson = False,
) -> None:
    """Draw pairs within tolerances (Monte Carlo): distribution of peak-to-peak STE with confidence bounds."""
    from service.cli.scatter import Wanted, run_scatter  # noqa: PLC0415 (start-up time)
    from service.convert.scatter import Sampling  # noqa: PLC0415
    from service.convert.task_workers import ExecutorChoice  # noqa: PLC0415

    distribution: Literal["uniform", "normal"] = "uniform" if uniform else "normal"
    sampling = Sampling(tolerance_class, misalignment_um, distribution, samples, seed)
    run_scatter(case, output, Wanted(sampling, ExecutorChoice(workers, dask)), as_json=json)


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
