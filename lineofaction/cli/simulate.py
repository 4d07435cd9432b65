"""``loa simulate``, and the tables of a scene's meshes, computed here or by a service."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dynamics.scene import Scene
from dynamics.simulation import interrupted_run, simulate_to_file
from dynamics.types import RunStatus
from fe_contact.ste import PairFacts, SteDatabase
from host import cpu_seconds
from host.directories import cache_home
from lineofaction.cli.analyze import analyzed, assessed_scene
from lineofaction.cli.guard import until_interrupted, warn, warnings_so_far
from lineofaction.cli.output import (
    Report,
    check_netcdf_output,
    console,
    print_json,
    print_result,
    progress_bar,
)
from lineofaction.cli.remote import watching
from lineofaction.client import LineOfActionClient
from lineofaction.client.scene_calls import ServiceTables
from lineofaction.client.steps import Steps, finished
from lineofaction.gearbox.convert.checks import check_case
from lineofaction.gearbox.convert.housings import housings_in
from lineofaction.gearbox.convert.plausibility import case_warnings, scene_warnings, within
from lineofaction.gearbox.convert.run_effects import model_lines
from lineofaction.gearbox.convert.runs import run_json, staged
from lineofaction.gearbox.convert.scene import TabledScene, check_scene, dynamic_scene
from lineofaction.gearbox.convert.stamp import stamp
from lineofaction.gearbox.convert.topology import facts_of
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.mesh_tables import MeshTables
from lineofaction.gearbox.problems import BadInput, JobFailed
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.scene_meshes import MeshInput
from lineofaction.gearbox.subjects import case_of_mesh, without_modes_files
from lineofaction.report.drawing.figure import number
from lineofaction.report.drawing.page import Headline

_ADVICE = "Name the service that holds it: --service http://127.0.0.1:8321"


def scene_with_tables(scene: SceneInput, folder: Path, service: str | None, report: Report) -> Scene:
    """Return the scene in SI with its tables; `folder` is what its files are relative to."""
    return tabled_scene(scene, folder, service, report).scene


def tabled_scene(scene: SceneInput, folder: Path, service: str | None, report: Report) -> TabledScene:
    """Return the scene with its tables and with its cases written out; see `scene_with_tables`."""
    if service is None:
        return _checked(scene, _Tables(MeshTables(folder, _Here(report)), finished), folder, report)
    with LineOfActionClient(service, progress=watching(report)) as client:
        tables = MeshTables(folder, ServiceTables(client))
        return _checked(scene, _Tables(tables, client.driver.run), folder, report)


@dataclass(frozen=True)
class _Tables:
    """Tables of meshes, and who performs the steps to get one."""

    tables: MeshTables
    run: Callable[[Steps[SteDatabase]], SteDatabase]

    def of(self, index: int, mesh: MeshInput) -> SteDatabase:
        """Return the database of a mesh."""
        return self.run(self.tables.of(index, mesh))


def _checked(scene: SceneInput, tables: _Tables, folder: Path, report: Report) -> TabledScene:
    """Check the scene before anything is computed for it, then reduce its housings and gather its tables."""
    began = cpu_seconds()
    facts = {mesh.name: _facts(i, mesh, folder, tables) for i, mesh in scene.with_database}
    warn(scene_warnings(scene, check_scene(scene, facts)))
    housings = housings_in(scene, cache_home(), folder, report)
    databases = {mesh.name: tables.of(i, mesh) for i, mesh in scene.with_database}
    built = dynamic_scene(scene, databases, housings)
    warn(scene_warnings(scene, built, {name: table.metadata.warnings for name, table in databases.items()}))
    return TabledScene(_written_out(scene, folder), databases, built, housings, cpu_seconds() - began)


def _written_out(scene: SceneInput, folder: Path) -> SceneInput:
    cases = [case_of_mesh(mesh, f"meshes[{i}]", folder) for i, mesh in enumerate(scene.meshes)]
    meshes = (
        mesh if case is None else mesh.model_copy(update={"case": case, "case_file": None})
        for mesh, case in zip(scene.meshes, cases, strict=True)
    )
    return without_modes_files(scene.model_copy(update={"meshes": tuple(meshes)}))


def _facts(index: int, mesh: MeshInput, folder: Path, tables: _Tables) -> PairFacts:
    """Return the facts of a mesh's pair; of a case without computing anything."""
    field = f"meshes[{index}]"
    case = case_of_mesh(mesh, field, folder)
    if case is None:
        return tables.of(index, mesh).facts
    try:
        warn(within(warning, field) for warning in case_warnings(case))
        return facts_of(check_case(case))
    except BadInput as error:
        raise error.within(f"{field}.case") from None


class _Here:
    """A source that computes databases in this process, and holds none."""

    def __init__(self, report: Report) -> None:
        self._report = report

    def by_hash(self, key: str) -> Steps[SteDatabase]:
        """Refuse: only a service knows hashes."""
        yield from ()
        raise BadInput.of("database_hash", key, "used together with a service", _ADVICE)

    def by_case(self, case: Case) -> Steps[SteDatabase]:
        """Compute."""
        yield from ()
        return analyzed(case, self._report)


# ``loa simulate``.


# The main figures of a run: how far its forces swing.


def run_headlines(peaks: Mapping[str, Any]) -> tuple[Headline, ...]:
    """Return the largest mesh force, and the largest force on a bearing, from the `peaks` of a receipt."""
    meshes = {name: (force["peak"], force["rms"]) for name, force in peaks.get("mesh_force", {}).items()}
    bearings = {
        f"{name}, {axis}": (peak, rms)
        for name, force in peaks.get("bearing_force", {}).items()
        for axis, peak, rms in zip("xyz", force["peak"], force["rms"], strict=True)
    }
    return tuple(
        _largest(what, forces)
        for what, forces in (("mesh force of", meshes), ("force on bearing", bearings))
        if forces
    )


def _largest(what: str, forces: dict[str, tuple[float, float]]) -> Headline:
    name = max(forces, key=lambda part: forces[part][0])
    peak, rms = forces[name]
    return Headline(f"largest {what} {name}", f"{number(peak, 4)} N", f"rms {number(rms, 4)} N")


def run_simulate(file: InputFile, output: Path, service: str | None, *, resume: bool, as_json: bool) -> None:
    """Gather the tables, integrate here into the file, print."""
    scene, folder = assessed_scene(file)
    check_netcdf_output(output)
    if resume and not interrupted_run(output).is_dir():
        advice = "There is none. Omit --resume to start a run."
        raise BadInput.of("--resume", str(output), "the file of a run that was interrupted", advice)
    with progress_bar() as report:
        _run(scene_with_tables(scene, folder, service, report), output, report, resume=resume)
    stamp(output, warnings_so_far())
    facts = {"file": str(output), **run_json(output)}
    if as_json:
        print_json(facts)
    else:
        _show(facts)


def _run(scene: Scene, output: Path, report: Report, *, resume: bool) -> None:
    """Integrate; say how a run ended that is not complete."""
    with until_interrupted() as cancel:
        status = simulate_to_file(scene, output, resume=resume, progress=staged(report), cancel=cancel)
    if status is RunStatus.CANCELLED:
        kept = f"What was computed is in {output}; --resume continues it."
        raise KeyboardInterrupt(f"interrupted. {kept}")
    if not status.usable:
        ended = status.name.lower().replace("_", " ")
        raise JobFailed(f"The run ended early: {ended}. What was computed is in {output}.")


def _show(facts: dict[str, Any]) -> None:
    """Print a run for people."""
    out = console()
    attributes, sizes = facts["attributes"], facts["dimensions"]
    for line in model_lines(attributes):
        out.print(line, highlight=False, soft_wrap=True)
    status = str(attributes["status"]).lower().replace("_", " ")
    out.print(f"run {status}: {sizes['time']} samples", highlight=False)
    print_result(run_headlines(attributes["receipt"].get("peaks", {})), [Path(str(facts["file"]))])
