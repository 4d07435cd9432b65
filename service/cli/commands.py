"""The verbs of ``loa``: arguments, help and examples; the module that does the work is loaded when asked."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli.guard import guarded

_EPILOG = (
    "Exit codes: 0 done; 2 bad input; 3 a mesh, a solve or a job failed; 4 no service answers; "
    "5 a defect (a log is named); 130 interrupted."
)
DEFAULT_SERVICE = "http://127.0.0.1:8321"

app = typer.Typer(
    name="loa",
    help="Open contact analysis for gear noise: STE databases of gear pairs, and the dynamics they excite.",
    epilog=_EPILOG,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)

AsJson = Annotated[bool, typer.Option("--json", help="Print JSON on standard output and nothing else.")]
Service = Annotated[str, typer.Option("--service", envvar="LOA_SERVICE", help="Address of the service.")]

StudyFile = Annotated[
    Path | None, typer.Option("-o", "--output", help="File ending in .nc, .json, .png or .html.")
]
TableService = Annotated[
    str | None,
    typer.Option("--service", help="Take the tables from this service instead of computing them here."),
]
_SPEEDS = "Speeds of the first driven shaft in rpm, 100:3000:50 or 300,600,900"


def main() -> None:
    """Run the command line."""
    app()


def _version(asked: bool) -> None:
    """Print the version and end."""
    if asked:
        from service.jobs.key import solver_version  # noqa: PLC0415 (start-up time)

        typer.echo(f"loa {solver_version()}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Hold the options of all verbs."""


@app.command(epilog="Example: loa analyze examples/palermo_spur_20_20.toml -o ste.nc")
@guarded
def analyze(
    case: Annotated[Path, typer.Argument(help="Case file (TOML, or JSON of the same shape).")],
    output: Annotated[Path, typer.Option("-o", "--output", help="STE database to write (netCDF).")],
    json: AsJson = False,
) -> None:
    """Compute the STE database of a case."""
    from service.cli.analyze import run_analyze  # noqa: PLC0415 (start-up time)

    run_analyze(case, output, as_json=json)


@app.command(epilog="Example: loa ste ste.nc --torque 100 --at 0,0.25,0.5")
@guarded
def ste(
    database: Annotated[Path, typer.Argument(help="STE database (netCDF).")],
    torque: Annotated[float | None, typer.Option(help="Torque on the driving gear in N m.")] = None,
    force: Annotated[float | None, typer.Option(help="Normal tooth force in N, instead of a torque.")] = None,
    at: Annotated[
        str | None,
        typer.Option(help="Positions by the driving gear in base pitches, 0 = pitch point: 0,0.25,0.5"),
    ] = None,
    misalignment_um: Annotated[float | None, typer.Option(help="Misalignment in um.")] = None,
    center_distance_change_mm: Annotated[
        float | None, typer.Option(help="Change of the centre distance in mm.")
    ] = None,
    csv: Annotated[bool, typer.Option("--csv", help="Print CSV.")] = False,
    json: AsJson = False,
) -> None:
    """Print one STE curve of a database, with load sharing, mean, peak-to-peak and harmonics."""
    from service.cli.ste import CurveRequest, run_ste  # noqa: PLC0415 (start-up time)

    request = CurveRequest(torque, force, at, misalignment_um, center_distance_change_mm)
    run_ste(database, request, as_csv=csv, as_json=json)


@app.command(epilog="Example: loa flank examples/palermo_spur_20_20.toml --torque 100 -o flank.nc")
@guarded
def flank(
    case: Annotated[Path, typer.Argument(help="Case file.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Flank results to write (netCDF).")],
    torque: Annotated[
        float | None,
        typer.Option(help="Torque on the driving gear in N m; default: the highest load."),
    ] = None,
    force: Annotated[float | None, typer.Option(help="Normal tooth force in N, instead of a torque.")] = None,
    misalignment_um: Annotated[
        float | None, typer.Option(help="Misalignment in um; default: the case's, nearest to 0.")
    ] = None,
    center_distance_change_mm: Annotated[
        float | None, typer.Option(help="Change of the centre distance in mm; default: likewise.")
    ] = None,
    json: AsJson = False,
) -> None:
    """Compute pressure, line load and gap on the flanks at one load: contact pattern and K_Hbeta."""
    from service.cli.flank import run_flank  # noqa: PLC0415 (start-up time)

    point = {
        "torque_n_m": torque,
        "normal_force_n": force,
        "misalignment_um": misalignment_um,
        "center_distance_change_mm": center_distance_change_mm,
    }
    run_flank(case, output, point, as_json=json)


@app.command(epilog="Example: loa export examples/palermo_spur_20_20.toml --torque 100 -o deformed")
@guarded
def export(
    case: Annotated[Path, typer.Argument(help="Case file; for an FMU an STE database, or a run.")],
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            help="Folder for pinion.vtu and wheel.vtu, made if missing; or MESH.fmu; of a run .unv or .csv.",
        ),
    ],
    torque: Annotated[
        float | None, typer.Option(help="Torque on the driving gear in N m; default: the highest load.")
    ] = None,
    force: Annotated[float | None, typer.Option(help="Normal tooth force in N, instead of a torque.")] = None,
    misalignment_um: Annotated[
        float | None, typer.Option(help="Misalignment in um; default: the case's, nearest to 0.")
    ] = None,
    center_distance_change_mm: Annotated[
        float | None, typer.Option(help="Change of the centre distance in mm; default: likewise.")
    ] = None,
    at: Annotated[str, typer.Option(help="Positions by the driving gear in base pitches.")] = "0",
    beside: Annotated[
        int, typer.Option(min=0, max=100, help="Unloaded teeth to show on either side, in three dimensions.")
    ] = 1,
    damping_n_s_per_m: Annotated[
        float, typer.Option(help="Mesh damping an FMU starts with in N s/m along the line of action.")
    ] = 0.0,
    backlash_um: Annotated[
        float | None,
        typer.Option(help="Of an FMU with coast flanks: along the transverse line of action, in um."),
    ] = None,
    function: Annotated[
        str, typer.Option(help="Of a run: time, spectrum (over frequency) or orders (over mesh orders).")
    ] = "time",
    start: Annotated[float | None, typer.Option("--from", help="Of a run: from this time in s.")] = None,
    end: Annotated[float | None, typer.Option("--to", help="Of a run: to this time in s.")] = None,
    json: AsJson = False,
) -> None:
    """Write both gears as they bend in mesh (ParaView), the mesh force as an FMU, or a run as UFF or CSV."""
    from service.cli.export import run_export  # noqa: PLC0415 (start-up time)
    from service.cli.export_fmu import run_export_fmu  # noqa: PLC0415
    from service.cli.export_run import is_for_runs, run_export_run  # noqa: PLC0415

    point = {
        "torque_n_m": torque,
        "normal_force_n": force,
        "misalignment_um": misalignment_um,
        "center_distance_change_mm": center_distance_change_mm,
    }
    if is_for_runs(output):
        run_export_run(case, output, function, (start, end), as_json=json)
    elif output.suffix == ".fmu":
        run_export_fmu(case, output, point, damping_n_s_per_m, backlash_um, as_json=json)
    else:
        run_export(case, output, point, at, beside, as_json=json)


@app.command(
    name="root-stress", epilog="Example: loa root-stress examples/palermo_spur_20_20.toml --torque 100"
)
@guarded
def root_stress(
    case: Annotated[Path, typer.Argument(help="Case file.")],
    torque: Annotated[
        float | None,
        typer.Option(help="Torque on the driving gear in N m; default: the highest load."),
    ] = None,
    force: Annotated[float | None, typer.Option(help="Normal tooth force in N, instead of a torque.")] = None,
    misalignment_um: Annotated[
        float | None, typer.Option(help="Misalignment in um; default: the case's, nearest to 0.")
    ] = None,
    center_distance_change_mm: Annotated[
        float | None, typer.Option(help="Change of the centre distance in mm; default: likewise.")
    ] = None,
    image: Annotated[
        Path | None, typer.Option(help="PNG file to draw the passage of one tooth of each gear to.")
    ] = None,
    csv: Annotated[bool, typer.Option("--csv", help="Print the passage of one tooth as CSV.")] = False,
    json: AsJson = False,
) -> None:
    """Compute the stress of the tooth roots at one load: peaks, where they are, and their history."""
    from service.cli.root_stress import run_root_stress  # noqa: PLC0415 (start-up time)

    point = {
        "torque_n_m": torque,
        "normal_force_n": force,
        "misalignment_um": misalignment_um,
        "center_distance_change_mm": center_distance_change_mm,
    }
    run_root_stress(case, point, image, as_csv=csv, as_json=json)


@app.command(epilog="Example: loa simulate examples/palermo_scene.toml -o run.nc")
@guarded
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


@app.command(epilog="Example: loa modes examples/palermo_scene.toml --speed-rpm 0:15000:250 -o modes.png")
@guarded
def modes(
    scene: Annotated[Path, typer.Argument(help="Scene file (TOML, or JSON of the same shape).")],
    speed_rpm: Annotated[str | None, typer.Option(help=f"{_SPEEDS}; left out: modes at rest only.")] = None,
    orders: Annotated[int, typer.Option(help="Multiples of the mesh frequencies to cross with modes.")] = 10,
    output: StudyFile = None,
    service: TableService = None,
    json: AsJson = False,
) -> None:
    """Find natural modes about the loaded equilibrium, whirl modes over speed, and critical speeds."""
    from service.cli.dynamic_studies import MODES, run_study  # noqa: PLC0415 (start-up time)
    from service.cli.speed_list import speed_list  # noqa: PLC0415

    asked = {"speed_rpm": speed_list(speed_rpm), "orders": orders}
    run_study(MODES, scene, output, service, asked, as_json=json)


@app.command(
    epilog="Example: loa response examples/palermo_scene.toml --speed-rpm 100:6000:25 -o response.png"
)
@guarded
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


@app.command(epilog="Example: loa steady scene.toml --speed-rpm 11000:13500:100 -o steady.png")
@guarded
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


@app.command(epilog="Example: loa report ste.nc run.nc -o report.html")
@guarded
def report(
    files: Annotated[
        list[Path],
        typer.Argument(help="STE database, flank results, studies, run; one of each kind."),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="Page to write.")] = Path("report.html"),
    images: Annotated[Path | None, typer.Option(help="Folder to write the plots to as PNG.")] = None,
    flank: Annotated[
        bool,
        typer.Option("--flank", help="Compute what happens on the flanks at the load the page names."),
    ] = False,
    json: AsJson = False,
) -> None:
    """Write one HTML page with the plots of a database, flank results or a run."""
    from service.cli.report import run_report  # noqa: PLC0415 (start-up time)

    run_report(files, output, images, flank=flank, as_json=json)


@app.command(epilog="Example: loa sensitivity examples/sensitivity_wind_turbine.toml -o sensitivity")
@guarded
def sensitivity(
    cases: Annotated[list[Path], typer.Argument(help="Case files; each becomes a line in the picture.")],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", help="Folder, or a file ending in .png, .csv, .json, .nc, .html."),
    ],
    misalignment_um: Annotated[str, typer.Option(help="Misalignments in um.")] = "0,15,30,45,60",
    center_distance_change_percent: Annotated[
        str, typer.Option(help="Changes of the centre distance in per cent.")
    ] = "-0.2,-0.1,0,0.1,0.2",
    json: AsJson = False,
) -> None:
    """Vary misalignment and centre distance of a case at its highest load: peak-to-peak STE."""
    from service.cli.sensitivity import run_sensitivity  # noqa: PLC0415 (start-up time)

    run_sensitivity(cases, output, misalignment_um, center_distance_change_percent, as_json=json)


@app.command(epilog="Example: loa plan examples/palermo_spur_20_20.toml --time-budget-s 5")
@guarded
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


@app.command(epilog="Example: loa ablate examples/palermo_spur_20_20.toml -o ablation.png")
@guarded
def ablate(
    file: Annotated[Path, typer.Argument(help="Case or scene file.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="File to write, ending in .png or .json.")
    ] = None,
    only: Annotated[
        str | None, typer.Option(help="Effects to switch over, separated by commas; default: all.")
    ] = None,
    json: AsJson = False,
) -> None:
    """Switch each effect of a case or a scene over: what it changes, what was estimated, what it costs."""
    from service.cli.ablate import run_ablate  # noqa: PLC0415 (start-up time)

    run_ablate(file, output, only, as_json=json)


@app.command(epilog="Example: loa frontier examples/palermo_spur_20_20.toml -o frontier")
@guarded
def frontier(
    file: Annotated[Path, typer.Argument(help="Case or scene file.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Folder, or a file ending in .png, .html, .json."),
    ] = None,
    rungs: Annotated[
        str | None, typer.Option(help="Rungs to run, separated by commas; default: all that are valid.")
    ] = None,
    json: AsJson = False,
) -> None:
    """Run the ladder on a case (ISO 6336 to fine finite elements) or on a scene: error against time."""
    from service.cli.frontier import run_frontier  # noqa: PLC0415 (start-up time)

    run_frontier(file, output, rungs, as_json=json)


@app.command(epilog="Example: loa hardcases --only table -o hardcases.html")
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
    """Run the hard scenes: cases known to break solvers, each judged by laws of physics."""
    from service.cli.hardcases import run_hardcases  # noqa: PLC0415 (start-up time)

    run_hardcases(only or [], output, as_json=json)


@app.command(epilog="Example: loa serve --port 8321 --workers 2")
@guarded
def serve(
    host: Annotated[str | None, typer.Option(help="Loopback address to listen on [LOA_HOST].")] = None,
    port: Annotated[int | None, typer.Option(help="Port; 0 takes a free one [LOA_PORT].")] = None,
    data_directory: Annotated[
        Path | None, typer.Option(help="Directory of jobs and results [LOA_DATA_DIRECTORY].")
    ] = None,
    workers: Annotated[int | None, typer.Option(help="Jobs at the same time [LOA_WORKERS].")] = None,
) -> None:
    """Serve jobs and results over HTTP on this machine, until stopped."""
    from service.cli.serve import run_serve  # noqa: PLC0415 (start-up time)

    run_serve(host=host, port=port, data_directory=data_directory, workers=workers)


@app.command(epilog="Example: loa submit examples/palermo_spur_20_20.toml --wait -o ste.nc")
@guarded
def submit(
    file: Annotated[Path, typer.Argument(help="Case or scene file.")],
    service: Service = DEFAULT_SERVICE,
    wait: Annotated[bool, typer.Option("--wait", help="Wait for the result.")] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Wait, and write the result here.")
    ] = None,
    process: Annotated[
        str | None,
        typer.Option(
            help="On a case analyze (default), flank or sensitivity; on a scene simulate "
            "(default), modes, response or steady; on both ablate."
        ),
    ] = None,
    inputs: Annotated[
        str | None, typer.Option(help="Further inputs of that process, as a JSON object.")
    ] = None,
    json: AsJson = False,
) -> None:
    """Submit a case or a scene to a service."""
    from service.cli.remote import Wish, run_submit  # noqa: PLC0415 (start-up time)

    run_submit(file, service, Wish(process, inputs), wait=wait, output=output, as_json=json)


@app.command(epilog="Example: loa fetch 3f1c0e5a-6c3d-4c1e-9b1e-2f6f0a1b2c3d -o ste.nc")
@guarded
def fetch(
    name: Annotated[str, typer.Argument(help="Identifier of a job, or content hash of a result.")],
    output: Annotated[
        Path, typer.Option("-o", "--output", help="File to write: netCDF, or JSON of an ablation.")
    ],
    service: Service = DEFAULT_SERVICE,
    json: AsJson = False,
) -> None:
    """Fetch the result of a job, or a result by its hash, from a service or the cache."""
    from service.cli.remote import run_fetch  # noqa: PLC0415 (start-up time)

    run_fetch(name, output, service, as_json=json)
