"""``loa simulate``: a scene with its tables, run into a file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dynamics.scene import Scene
from dynamics.simulation import interrupted_run, simulate_to_file
from dynamics.types import RunStatus
from lineofaction.cli.costs import announce_cost, simulation_cost, tables_cost
from lineofaction.cli.output import (
    Report,
    check_netcdf_output,
    console,
    output_of,
    print_headlines,
    print_json,
    print_parts,
    print_written,
)
from lineofaction.cli.scene_tables import tabled_scene
from lineofaction.cli.subjects import assessed_scene
from lineofaction.cli.verb_warnings import warnings_so_far
from lineofaction.gearbox.convert.effects import run_lines
from lineofaction.gearbox.executor import open_executor
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.interrupts import until_interrupted
from lineofaction.gearbox.problems import BadInput, JobFailed
from lineofaction.gearbox.progress_bars import progress_bar
from lineofaction.gearbox.project import RUN
from lineofaction.gearbox.result_figures import run_json
from lineofaction.gearbox.result_files import stamp, stamp_scene
from lineofaction.gearbox.stages import staged
from lineofaction.gearbox.studies.excitations import scene_metadata
from lineofaction.report.drawing.figure import number
from lineofaction.report.drawing.page import Headline
from lineofaction.report.presentation import effect_text


def run_simulate(
    file: InputFile,
    output: Path | None,
    executor: tuple[int, str | None],
    service: str | None,
    *,
    resume: bool,
    as_json: bool,
) -> None:
    """Gather the tables, integrate the scene in this process into a file, and print the main results.

    Parameters
    ----------
    output : Path, optional
        File of the run; None: that of the project.
    executor : (int, str or None)
        Number of worker processes and address of a Dask scheduler, for the tables.
    service : str, optional
        Address of a service that computes the tables.
    resume : bool
        Continue the interrupted run of the file.
    """
    scene, folder = assessed_scene(file)
    run_file = output_of(output, file.project, RUN)
    check_netcdf_output(run_file)
    if resume and not interrupted_run(run_file).is_dir():
        remedy = "There is none. Omit --resume to start a run."
        raise BadInput.of("--resume", str(run_file), "the file of a run that was interrupted", remedy)
    if not as_json:
        costs = [simulation_cost(scene, folder)]
        announce_cost("simulate", costs if service else [*costs, tables_cost(scene, folder)])
    with open_executor(*executor) as workers, progress_bar() as report:
        tabled = tabled_scene(scene, folder, service, report, workers)
        _run(tabled.scene, run_file, report, resume=resume)
    stamp(run_file, warnings_so_far())
    stamp_scene(run_file, scene_metadata(tabled))
    answer = {"file": str(run_file), **run_json(run_file)}
    if as_json:
        print_json(answer)
    else:
        _show(answer)


def _run_headlines(peaks: Mapping[str, Any]) -> tuple[Headline, ...]:
    """Return the largest mesh force, and the largest force on a bearing, from the `peaks` of a receipt."""
    meshes = {name: (force["peak"], force["rms"]) for name, force in peaks.get("mesh_force", {}).items()}
    bearings = {
        f"{name}, {axis}": (peak, rms)
        for name, force in peaks.get("bearing_force", {}).items()
        for axis, peak, rms in zip("xyz", force["peak"], force["rms"], strict=True)
    }
    headlines = []
    for quantity, forces in (("mesh force of", meshes), ("force on bearing", bearings)):
        if forces:
            name, (peak, rms) = max(forces.items(), key=lambda entry: entry[1][0])  # by peak
            value, remark = f"{number(peak, 4)} N", f"rms {number(rms, 4)} N"
            headlines.append(Headline(f"largest {quantity} {name}", value, remark))
    return tuple(headlines)


def _run(scene: Scene, output: Path, report: Report, *, resume: bool) -> None:
    """Integrate; raise KeyboardInterrupt or `JobFailed` for a run that is not complete."""
    with until_interrupted() as cancel:
        status = simulate_to_file(scene, output, resume=resume, progress=staged(report), cancel=cancel)
    if status is RunStatus.CANCELLED:
        remedy = f"What was computed is in {output}; --resume continues it."
        raise KeyboardInterrupt(f"interrupted. {remedy}")
    if not status.usable:
        ended = status.name.lower().replace("_", " ")
        raise JobFailed(f"The run ended early: {ended}. What was computed is in {output}.")


def _show(answer: dict[str, Any]) -> None:
    out = console()
    attributes, sizes = answer["attributes"], answer["dimensions"]
    status = str(attributes["status"]).lower().replace("_", " ")
    out.print(f"run {status}: {sizes['time']} samples")
    print_headlines(_run_headlines(attributes["receipt"].get("peaks", {})))
    print_parts((*effect_text(attributes.get("effect_ledger", {})), *run_lines(attributes)))
    print_written([Path(str(answer["file"]))])
