"""Functions of a Python user without a server: open, read, analyze, simulate, study."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from contextlib import nullcontext
from dataclasses import replace
from inspect import currentframe
from pathlib import Path
from typing import Any, Unpack, overload

from dynamics.errors import SolveError
from dynamics.results import RunResult
from dynamics.scene import Scene
from dynamics.simulation import simulate as run_scene
from dynamics.types import RunStatus
from fe_contact import analyze as analyze_pair
from fe_contact.analysis.database.refined_table import OnDraft
from fe_contact.geometry import ParallelAxes
from fe_contact.keywords import TableKeywords
from fe_contact.options import AnalysisOptions, Run, TableAxes
from fe_contact.ste import SteDatabase
from fe_contact.types import Json
from host.directories import cache_home
from lineofaction.gearbox.convert.case_plausibility import case_warnings
from lineofaction.gearbox.convert.checked_case import CheckedCase, CheckedCases
from lineofaction.gearbox.convert.housings import HousedScene, housings_in
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.from_rexs.assumptions import Assumption
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.input_file import InputFile, Override
from lineofaction.gearbox.interrupts import until_interrupted
from lineofaction.gearbox.mesh_tables import MeshTables, finished
from lineofaction.gearbox.problems import BadInput, JobFailed
from lineofaction.gearbox.progress_bars import ProgressChoice, progress_display
from lineofaction.gearbox.rexs.files import read_rexs
from lineofaction.gearbox.schemas import Case, read_model, read_table, validated
from lineofaction.gearbox.schemas.files import READERS, written_out
from lineofaction.gearbox.schemas.named_files import in_folder
from lineofaction.gearbox.schemas.plan import omission_warnings
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.stages import staged
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.study import Study
from lineofaction.gearbox.study_cache import cached_workers
from lineofaction.gearbox.subjects import Subject, case_of, scene_of, with_absolute_paths
from lineofaction.gearbox.tabled_scene import ComputedTables, SceneRuns, checked_table, database_of
from lineofaction.gearbox.tabled_scene import tabled_scene as scene_by_tables
from model_studies.progress import Progress, silent
from model_studies.workers import InProcess, Workers
from model_studies.workers.content_digest import content_digest


class InputWarning(UserWarning):
    """Warning of an implausible input, or of a part that an import leaves out."""


def open_unit(
    file: Path | str, assume: Iterable[str] = (), overrides: Mapping[str, object] | None = None
) -> OpenedUnit:
    """Open the gear unit of a REXS file.

    Raises `BadInput`: the file is none, or one of its values has the wrong type or unit.

    Parameters
    ----------
    file : path
        File in any version of REXS: XML, JSON or a ZIP of them.
    assume : iterable of str
        Values over those of the file, ``ID.attribute=value`` in its units.
    overrides : mapping of str to object, optional
        Values over those of its scene by their paths, as ``{"housings": [...]}``; the files they name
        are relative to the working directory.

    Returns
    -------
    OpenedUnit
        Its stages as `cases`, the whole as `scene`, `load_cases`, and `lines`: what became of every value.
        What the scene leaves out is `left_out`, and warned of.
    """
    unit = OpenedUnit.of(read_rexs(Path(file)), [Assumption.of(text) for text in assume])
    if overrides and unit.scene is not None:
        table = _over(overrides, Path(file)).applied(unit.scene.model_dump(mode="json", exclude_unset=True))
        unit = replace(unit, scene=validated(SceneInput, written_out(table, in_folder(Path()), READERS)))
    _warn(omission_warnings(unit.omitted))
    return unit


def read(file: Path | str, overrides: Mapping[str, object] | None = None) -> Case | SceneInput:
    """Read a case or a scene file.

    Raises `BadInput`.

    Parameters
    ----------
    file : path
        TOML or JSON; what has shafts is a scene. The files that it names are relative to its folder.
    overrides : mapping of str to object, optional
        Values over those of the file by their paths, as ``{"loads.brake.torque_n_m": 40}``.
    """
    path = Path(file)
    source = _over(overrides or {}, path)
    if "shafts" not in read_table(source):
        return read_model(Case, source)
    return with_absolute_paths(read_model(SceneInput, source), path.parent.absolute())


def _over(overrides: Mapping[str, object], path: Path) -> InputFile:
    return InputFile(path, tuple(Override(name, value) for name, value in overrides.items()))


@overload
def analyze(
    subject: ParallelAxes,
    axes: TableAxes | None = None,
    options: AnalysisOptions = ...,
    run: Run = ...,
    *,
    case: Json | None = None,
    on_draft: OnDraft | None = None,
    **keywords: Unpack[TableKeywords],
) -> SteDatabase: ...
@overload
def analyze(
    subject: Subject,
    *,
    progress: ProgressChoice = ...,
    workers: Workers = ...,
    on_draft: OnDraft | None = None,
) -> SteDatabase: ...
def analyze(subject: ParallelAxes | Subject, *request: Any, **keywords: Any) -> SteDatabase:
    """Compute the static transmission error of a gear pair or a case.

    A pair takes its request in SI: axes, options and run, or their members as keywords, as of
    `fe_contact.analyze`. A case states all of it but `progress` (as of `simulate`), `workers` and `on_draft`.
    A case that is interrupted (Ctrl-C) after a table has its draft as result, with a warning.

    Raises `BadInput`, `InputError`, `InfeasibleGeometry`.
    """
    if isinstance(subject, ParallelAxes):
        return analyze_pair(subject, *request, **keywords)
    case = CheckedCase(case_of(_source(subject)))
    _warn(case_warnings(case))
    return _table_of(case, *request, **keywords)


def _table_of(
    case: CheckedCase,
    *,
    progress: ProgressChoice = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
    on_draft: OnDraft | None = None,
) -> SteDatabase:
    """Return the table of a case; interrupted, the last draft of it."""
    drafts: list[SteDatabase] = []

    def note(draft: SteDatabase, refinement: str) -> None:
        drafts.append(draft)
        if on_draft is not None:
            on_draft(draft, refinement)

    try:
        with progress_display(progress) as report:
            return database_of(case, cache_home(), report, workers, note)
    except KeyboardInterrupt:
        if not drafts:
            raise
        _warn([{"message": "Interrupted: this table does not meet its tolerance yet."}])
        return drafts[-1]


def simulate(
    subject: Scene | Subject,
    progress: ProgressChoice = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> RunResult:
    """Run a scene: in SI, or as written, with the tables of its meshes computed first.

    A run that is interrupted (Ctrl-C) ends there: its status is `CANCELLED`, and a warning says so.

    Parameters
    ----------
    progress : callable or bool, optional
        Function that is called as progress(stage, fraction); True: bars on a terminal, a bar in a notebook;
        False: nothing. Default: in a notebook a bar after two seconds, elsewhere nothing.
    workers : Workers, optional
        Executor of the tables; default: this process.

    Raises
    ------
    BadInput
        No such scene, or it does not move.
    JobFailed
        The run ended early; see `dynamics.simulation.simulate` for its states.
    """
    with progress_display(progress) as report:
        scene = subject if isinstance(subject, Scene) else tabled(subject, report, workers).scene
        run = _run(scene, report)
    if not run.status.usable and run.status is not RunStatus.CANCELLED:
        raise JobFailed(f"The run ended early: {run.status.name.lower().replace('_', ' ')}.")
    return run


def _run(scene: Scene, report: Progress) -> RunResult:
    """Return the run of a scene; interrupted, the part up to then."""
    with until_interrupted() as cancel:
        try:
            return run_scene(scene, staged(report), cancel)
        except SolveError as error:
            run = error.partial
            if not (isinstance(run, RunResult) and run.status is RunStatus.CANCELLED):
                raise
    _warn([{"message": f"Interrupted: the run ends at {run.time[-1]:.6g} s."}])
    return run


def tabled(
    subject: Subject,
    progress: Progress = silent,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> TabledScene:
    """Return a scene with the tables of its meshes, computed here, and its housings reduced."""
    return _tabled_scene(*_scene(subject), progress, workers)


def _tabled_scene(scene: SceneInput, folder: Path, progress: Progress, workers: Workers) -> TabledScene:
    _warn(omission_warnings(scene.left_out))
    cases = CheckedCases()
    runs = SceneRuns(scene, folder, cases, Run(workers, cache_home() / "compliance", progress))
    computed = ComputedTables(lambda case: checked_table(cases.of(case), runs.of(case)))
    tables = MeshTables(folder, computed)
    return scene_by_tables(
        scene,
        folder,
        lambda index, mesh: finished(tables.of(index, mesh)),
        cache_home(),
        progress,
        _warn,
        cases,
    )


def studied(
    study: Study,
    subject: Subject,
    inputs: Mapping[str, Any],
    *,
    run: RunResult | None,
    workers: Workers | None,
    progress: ProgressChoice,
    folder: Path | None,
) -> Any:
    """Return the result of a study, as its function does; raises `BadInput`, `JobFailed`."""
    work, named = study.run, {} if run is None else {"run": content_digest(run)}
    varied = validated(study.inputs, {**named, **inputs})
    written_subject, files = _as_written(study, subject)
    chosen = work.narrowed(written_subject, varied)
    work.check(chosen, varied)
    content = chosen.case if isinstance(chosen, CheckedCase) else chosen
    interrupts = until_interrupted if work.interruptible else nullcontext
    with (
        progress_display(progress, study.stages) as report,
        cached_workers(study, [content], varied, workers or InProcess()) as remembering,
        interrupts() as cancel,
    ):
        means = Means(cache_home(), report, remembering, cancel, folder, run)
        computed_subject = chosen if isinstance(chosen, CheckedCase) else _made(study, chosen, files, means)
        result = work.compute(computed_subject, varied, means)
        if cancel is not None and cancel():
            _warn([{"message": "Interrupted: the result is the best so far."}])
    _warn(work.warnings(result) or ())
    if failure := work.failure(result):
        raise JobFailed(failure)
    return result


def _as_written(study: Study, subject: Subject) -> tuple[CheckedCase | SceneInput, Path]:
    """Return the case or scene of a study as written, and the folder of its files."""
    kind = study.takes.subject
    if kind == "scene" or (kind != "case" and _has_shafts(subject)):
        return _scene(subject)
    case = CheckedCase(case_of(_source(subject)))
    _warn(case_warnings(case))
    return case, Path()


def _made(study: Study, scene: SceneInput, folder: Path, means: Means) -> TabledScene | HousedScene:
    """Return a scene with its tables, or only with its housings, as the study takes it."""
    if study.run.tables:
        return _tabled_scene(scene, folder, means.report, means.workers)
    _warn(omission_warnings(scene.left_out))
    return HousedScene(scene, housings_in(scene, cache_home(), folder, means.report))


def _scene(subject: Any) -> tuple[SceneInput, Path]:
    """Return a scene and the folder of its files; a unit's scene has its cases written out."""
    if not isinstance(subject, OpenedUnit):
        return scene_of(_source(subject))
    if subject.scene is None:
        raise BadInput.of(
            "unit", "without a scene", "one whose file has what a scene needs", "See its lines."
        )
    cases = {f"{case.name}.toml": case.case for case in subject.cases}
    meshes = tuple(
        mesh.model_copy(update={"case": cases[mesh.case_file], "case_file": None})
        if mesh.case_file is not None
        else mesh
        for mesh in subject.scene.meshes
    )
    return subject.scene.model_copy(update={"meshes": meshes}), Path()


def _has_shafts(subject: Any) -> bool:
    if isinstance(subject, Path | str):
        return "shafts" in read_table(Path(subject))
    return "shafts" in subject if isinstance(subject, Mapping) else not isinstance(subject, Case)


def _source(subject: Any) -> Any:
    """Return a path for a name of a file."""
    return Path(subject) if isinstance(subject, str) else subject


def _warn(findings: Iterable[Mapping[str, Any]]) -> None:
    """Warn of each finding once, at the line of the caller's code."""
    frame, level = currentframe(), 0  # level: number of frames of this package
    while frame and str(frame.f_globals.get("__name__")).startswith("lineofaction."):
        frame, level = frame.f_back, level + 1
    for warning in findings:
        warnings.warn(warning["message"], InputWarning, stacklevel=level + 1)
