"""Verbs on scenes: runs, modes, forced response, steady states."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli.guard import computing
from service.cli.verbs.options import AsJson, StudyFile, TableService

verbs = typer.Typer()
_SPEEDS = "Speeds of the first driven shaft in rpm, 100:3000:50 or 300,600,900"


@verbs.command(epilog="Example: loa simulate examples/palermo_scene.toml -o run.nc")
@computing
def simulate(
    scene: Annotated[Path, typer.Argument(help="Scene file (TOML, or JSON of the same shape).")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Run to write (netCDF).")],
    service: TableService = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with a run that was interrupted or killed.")
    ] = False,
    json: AsJson = False,
) -> None:
    """Run the dynamics of a scene; Ctrl-C ends it with what was computed, to be resumed."""
    from service.cli.simulate import run_simulate  # noqa: PLC0415 (start-up time)

    run_simulate(scene, output, service, resume=resume, as_json=json)


@verbs.command(epilog="Example: loa modes examples/palermo_scene.toml --speed-rpm 0:15000:250 -o modes.png")
@computing
def modes(
    scene: Annotated[Path, typer.Argument(help="Scene file (TOML, or JSON of the same shape).")],
    speed_rpm: Annotated[str | None, typer.Option(help=f"{_SPEEDS}; left out: modes at rest only.")] = None,
    orders: Annotated[int, typer.Option(help="Multiples of the mesh frequencies to cross with modes.")] = 10,
    highest_frequency_hz: Annotated[
        float | None,
        typer.Option(help="To which shafts are resolved; left out: the highest order at the highest speed."),
    ] = None,
    output: StudyFile = None,
    service: TableService = None,
    json: AsJson = False,
) -> None:
    """Find natural modes about the loaded equilibrium, whirl modes over speed, and critical speeds."""
    from service.cli.dynamic_studies import MODES, run_study  # noqa: PLC0415 (start-up time)
    from service.cli.speed_list import speed_list  # noqa: PLC0415

    asked = {
        "speed_rpm": speed_list(speed_rpm),
        "orders": orders,
        "highest_frequency_hz": highest_frequency_hz,
    }
    run_study(MODES, scene, output, service, asked, as_json=json)


@verbs.command(
    epilog="Example: loa response examples/palermo_scene.toml --speed-rpm 100:6000:25 -o response.png"
)
@computing
def response(
    scene: Annotated[Path, typer.Argument(help="Scene file (TOML, or JSON of the same shape).")],
    speed_rpm: Annotated[str, typer.Option(help=f"{_SPEEDS}.")],
    orders: Annotated[int, typer.Option(help="Harmonics of the mesh frequency.")] = 10,
    output: StudyFile = None,
    service: TableService = None,
    json: AsJson = False,
) -> None:
    """Find the linear response to the transmission error over speed: mesh and bearing forces by order."""
    from service.cli.dynamic_studies import RESPONSE, run_study  # noqa: PLC0415 (start-up time)
    from service.cli.speed_list import speed_list  # noqa: PLC0415

    asked = {"speed_rpm": speed_list(speed_rpm), "orders": orders}
    run_study(RESPONSE, scene, output, service, asked, as_json=json)


@verbs.command(epilog="Example: loa steady scene.toml --speed-rpm 11000:13500:100 -o steady.png")
@computing
def steady(
    scene: Annotated[Path, typer.Argument(help="Scene file (TOML, or JSON of the same shape).")],
    speed_rpm: Annotated[str, typer.Option(help=f"{_SPEEDS}.")],
    branch: Annotated[
        bool, typer.Option(help="Follow the branch between the ends, with its unstable parts.")
    ] = True,
    repeat: Annotated[
        int, typer.Option(help="Periods after which motions repeat; 2 finds what period doubling leads to.")
    ] = 1,
    settling_periods: Annotated[int, typer.Option(help="Periods a sweep settles for at each speed.")] = 64,
    output: StudyFile = None,
    service: TableService = None,
    json: AsJson = False,
) -> None:
    """Find periodic steady states at rising and falling speeds by shooting: stability, jumps, contact."""
    from service.cli.dynamic_studies import STEADY, run_study  # noqa: PLC0415 (start-up time)
    from service.cli.speed_list import speed_list  # noqa: PLC0415

    asked = {"speed_rpm": speed_list(speed_rpm), "branch": branch, "repeat": repeat}
    asked |= {"settling_periods": settling_periods}
    run_study(STEADY, scene, output, service, asked, as_json=json)
