"""STE databases of cases and of the meshes of scenes, computed in this process or by its workers."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from fe_contact.options import Run
from fe_contact.ste import PairGeometry, SteDatabase
from host import cpu_seconds
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.case import allowed_misalignment, case_json
from lineofaction.gearbox.convert.case_plausibility import case_warnings, phrased_for
from lineofaction.gearbox.convert.checked_case import CheckedCase, CheckedCases
from lineofaction.gearbox.convert.housings import housings_in
from lineofaction.gearbox.convert.plausibility import scene_warnings, within
from lineofaction.gearbox.convert.scene import TabledScene, check_scene, dynamic_scene
from lineofaction.gearbox.mesh_tables import Steps
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.meshes import MeshInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.subjects import with_case, with_inline_cases, without_modes_files
from model_studies.progress import Progress, by_cost, silent
from model_studies.workers import InProcess, Workers

ANALYSIS = "analysis"
"""Stage of the tables of a scene."""
Warn = Callable[[Iterable[dict[str, Any]]], object]
"""Called with warnings, each a record of plain JSON."""
OnDraft = Callable[[SteDatabase, str], None]
"""Called with every table that does not meet the tolerance yet, and with what is refined next."""
TableOf = Callable[[int, MeshInput], SteDatabase]
"""Returns the table of a mesh by its index and its input."""
CachedTable = Callable[[Case], SteDatabase | None]
"""Returns the table of a case if it was computed before, or None."""


def tabled_scene(
    scene: SceneInput,
    folder: Path,
    table_of: TableOf,
    home: Path,
    progress: Progress,
    warn: Warn,
    cases: CheckedCases,
    cached_table: CachedTable = lambda _case: None,
) -> TabledScene:
    """Return a scene with its tables and reduced housings; all is checked before anything is computed.

    Parameters
    ----------
    folder : Path
        Folder to which the names of files in the scene are relative.
    table_of : callable
        ``table_of(index, mesh)``, the database of a mesh.
    home : Path
        Folder of the caches.
    progress : callable
        Called as progress(stage, fraction).
    warn : callable
        Takes warnings about what is implausible in cases and scene.
    cases : CheckedCases
        Checked cases of this scene: `table_of` continues from these checks.
    cached_table : callable
        ``cached_table(case)``, the table of a case that was computed before, which needs no check, or None.

    Raises
    ------
    BadInput
        The scene does not exist or does not move, or one of its files cannot be used.
    JobFailed
        A table has failed points.
    """
    began = cpu_seconds()
    meshes, geometry = list(scene.meshes), {}
    for i, mesh in scene.with_database:
        meshes[i] = with_case(mesh, f"meshes[{i}]", folder)
        geometry[mesh.name] = _pair_geometry(i, meshes[i], table_of, cases, warn, cached_table)
    warn(scene_warnings(scene, check_scene(scene, geometry)))
    if any(part.is_measured for part in scene.housings):
        from lineofaction.gearbox.convert.measured_housings import read_responses  # noqa: PLC0415 (start-up)

        read_responses(scene)
    housings = housings_in(scene, home, folder, progress)
    databases = {mesh.name: table_of(i, meshes[i]) for i, mesh in scene.with_database}
    built = dynamic_scene(scene, databases, housings)
    warn(scene_warnings(scene, built, {name: table.metadata.warnings for name, table in databases.items()}))
    if housings or scene.complaint is not None:
        from lineofaction.gearbox.level_quantity import with_quantity  # noqa: PLC0415 (start-up time)

        built = with_quantity(built, scene, housings)
    with_cases = with_inline_cases(scene.model_copy(update={"meshes": tuple(meshes)}), folder)
    return TabledScene(without_modes_files(with_cases), databases, built, housings, cpu_seconds() - began)


def database_of(
    case: CheckedCase,
    home: Path,
    progress: Progress = silent,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
    on_draft: OnDraft | None = None,
) -> SteDatabase:
    """Compute the STE database of a case; condensed gears are kept in `home`, the folder of caches.

    Raises `BadInput`: the pair cannot exist, or cannot carry these loads.
    """
    run = Run(workers, home / "compliance", progress)
    return checked_table(case, run, on_draft)


def checked_table(case: CheckedCase, run: Run, on_draft: OnDraft | None = None) -> SteDatabase:
    """Compute the STE database of a case, its warnings in the fields and units of the case."""
    from fe_contact.analysis.analyze import analyze  # noqa: PLC0415 (start-up time)

    with boundary_errors():
        database = analyze(case.checked, run=run, case=case_json(case.case), on_draft=on_draft)
    metadata = database.metadata
    allowed = allowed_misalignment(case.case)
    if allowed is not None:
        receipt = metadata.receipt | {"misalignment_range": allowed.text}
        metadata = replace(metadata, receipt=receipt)
    warnings = phrased_for(case.case, metadata.warnings)
    return replace(database, metadata=replace(metadata, warnings=warnings))


class SceneRuns:
    """The runs of the tables of a scene, which together report the fraction done of the stage `ANALYSIS`.

    Each table counts by its predicted cost.

    Parameters
    ----------
    folder : Path
        Folder to which the names of files in the scene are relative.
    cases : CheckedCases
        Checked cases of this scene.
    run : Run
        Workers, cache and progress of all tables.
    cached : callable
        ``cached(case)``, whether the table of a case is not computed.
    """

    def __init__(
        self,
        scene: SceneInput,
        folder: Path,
        cases: CheckedCases,
        run: Run,
        cached: Callable[[Case], bool] = lambda _case: False,
    ) -> None:
        self._scene, self._folder = scene, folder
        self._cases, self._run, self._cached = cases, run, cached
        self._progress: Progress | None = None  # of the tables by the text of their cases

    def of(self, case: Case) -> Run:
        """Return the run of the table of a case; the first call comes after all cases were checked."""
        if self._progress is None:
            self._progress = by_cost(partial(self._run.progress, ANALYSIS), self._seconds())
        refines = case.accuracy.tolerance is not None
        return self._run.reporting(partial(self._progress, case.model_dump_json()), refines=refines)

    def _seconds(self) -> dict[str, float]:
        """Return the predicted CPU seconds of the tables that are computed, by the text of their cases."""
        meshes = with_inline_cases(self._scene, self._folder).meshes
        cases = [case for mesh in meshes if (case := mesh.case) is not None and not self._cached(case)]
        by_text = {case.model_dump_json(): case for case in cases}
        if len(by_text) == 1:
            return dict.fromkeys(by_text, 1.0)  # its part of the stage needs no plan
        return {text: self._predicted(case) for text, case in by_text.items()}

    def _predicted(self, case: Case) -> float:
        from lineofaction.gearbox.convert.plan import costs_of  # noqa: PLC0415 (start-up time)

        return sum(cost.cpu_seconds for cost in costs_of(self._cases.of(case), self._run.cache))


class ComputedTables:
    """A source of tables that computes them in this process, and holds none.

    Its methods are generators, as those of sources that wait for a service; they yield nothing.

    `compute`: ``compute(case)``, the database of a case.
    """

    def __init__(self, compute: Callable[[Case], SteDatabase]) -> None:
        self._compute = compute

    def by_hash(self, key: str) -> Steps[SteDatabase]:
        """Refuse: only a service knows hashes."""
        yield from ()  # makes the method a generator
        remedy = "Name the service that holds it: --service http://127.0.0.1:8321"
        raise BadInput.of("database_hash", key, "used together with a service", remedy)

    def by_case(self, case: Case) -> Steps[SteDatabase]:
        """Compute the table of a case."""
        yield from ()  # makes the method a generator
        return self._compute(case)


def _pair_geometry(
    index: int, mesh: MeshInput, table_of: TableOf, cases: CheckedCases, warn: Warn, cached_table: CachedTable
) -> PairGeometry:
    """Return the geometry of the pair of a mesh: from its case, or from its table if that is there.

    A case of which no table is cached gives the geometry after its checks alone: nothing is computed.
    """
    if mesh.case is None or cached_table(mesh.case) is not None:
        return table_of(index, mesh).geometry
    field, checked = f"meshes[{index}]", cases.of(mesh.case)
    try:
        warn(within(warning, field) for warning in case_warnings(checked))
        return PairGeometry.of(checked.feasible.request.pair)
    except BadInput as error:
        raise error.within(f"{field}.case") from None
