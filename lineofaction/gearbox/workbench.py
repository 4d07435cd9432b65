"""What a Python user does with a gearbox, without a server: open, read, analyze, simulate, study."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from dynamics.results import RunResult
from dynamics.scene import Scene
from dynamics.simulation import simulate as run_scene
from fe_contact import analyze as analyze_pair
from fe_contact.geometry import ParallelAxes
from fe_contact.ste import SteDatabase
from host.directories import cache_home
from lineofaction.gearbox.convert.case import CheckedCase, CheckedCases
from lineofaction.gearbox.convert.housings import HousedScene, housings_in
from lineofaction.gearbox.convert.plausibility import case_warnings
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.from_rexs.account import Assumption
from lineofaction.gearbox.from_rexs.opened import OpenedUnit, opened
from lineofaction.gearbox.input_file import InputFile, Override
from lineofaction.gearbox.problems import BadInput, JobFailed
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.rexs.files import read_rexs
from lineofaction.gearbox.schemas import Case, read_model, read_table, validated
from lineofaction.gearbox.schemas.files import READERS, beside, written_out
from lineofaction.gearbox.schemas.plan import left_out_warnings
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Computation, Means
from lineofaction.gearbox.subjects import MeshTables, case_of, finished, scene_of, with_own_files
from lineofaction.gearbox.tabled_scene import ComputedTables, database_of
from lineofaction.gearbox.tabled_scene import tabled_scene as scene_by_tables
from model_studies.progress import Progress, silent
from model_studies.workers import InProcess, Workers
from model_studies.workers.remembering import content_digest

if TYPE_CHECKING:
    from lineofaction.gearbox.studies.ablate.run import RUN as ABLATE
    from lineofaction.gearbox.studies.deflect.run import RUN as DEFLECT
    from lineofaction.gearbox.studies.flank.run import RUN as FLANK
    from lineofaction.gearbox.studies.frontier.run import RUN as FRONTIER
    from lineofaction.gearbox.studies.listen.run import RUN as LISTEN
    from lineofaction.gearbox.studies.modes.run import RUN as MODES
    from lineofaction.gearbox.studies.noise.run import RUN as NOISE
    from lineofaction.gearbox.studies.optimize.run import RUN as OPTIMIZE
    from lineofaction.gearbox.studies.response.run import RUN as RESPONSE
    from lineofaction.gearbox.studies.root_stress.run import RUN as ROOT_STRESS
    from lineofaction.gearbox.studies.scatter.run import RUN as SCATTER
    from lineofaction.gearbox.studies.sensitivity.run import RUN as SENSITIVITY
    from lineofaction.gearbox.studies.steady.run import RUN as STEADY
    from lineofaction.gearbox.studies.study.run import RUN as STUDY
    from lineofaction.gearbox.studies.sweep.run import RUN as SWEEP
    from lineofaction.gearbox.studies.vibration.run import RUN as VIBRATION

Subject = Case | SceneInput | OpenedUnit | Mapping[str, Any] | Path | str
Result = TypeVar("Result")


class InputWarning(UserWarning):
    """What is implausible about an input, or was left out of it."""


def open_unit(
    file: Path | str, assume: Iterable[str] = (), overrides: Mapping[str, object] | None = None
) -> OpenedUnit:
    """Open the gear unit of a REXS file.

    Parameters
    ----------
    file : path
        Of any version of REXS: XML, JSON or a ZIP of them.
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

    Raises
    ------
    BadInput
        The file is none, or one of its values has the wrong type or unit.
    """
    unit = opened(read_rexs(Path(file)), [Assumption.of(text) for text in assume])
    if overrides and unit.scene is not None:
        table = _over(overrides, Path(file)).applied(unit.scene.model_dump(mode="json", exclude_unset=True))
        unit = replace(unit, scene=validated(SceneInput, written_out(table, beside(Path()), READERS)))
    _warn(left_out_warnings(unit.left_out))
    return unit


def read(file: Path | str, overrides: Mapping[str, object] | None = None) -> Case | SceneInput:
    """Read a case or a scene file.

    Parameters
    ----------
    file : path
        TOML or JSON; what has shafts is a scene. The files that it names are relative to its folder.
    overrides : mapping of str to object, optional
        Values over those of the file by their paths, as ``{"loads.brake.torque_n_m": 40}``.

    Raises
    ------
    BadInput
    """
    path = Path(file)
    source = _over(overrides or {}, path)
    if "shafts" not in read_table(source):
        return read_model(Case, source)
    return with_own_files(read_model(SceneInput, source), path.parent.absolute())


def _over(overrides: Mapping[str, object], path: Path) -> InputFile:
    return InputFile(path, tuple(Override(name, value) for name, value in overrides.items()))


def analyze(subject: ParallelAxes | Subject, **options: Any) -> SteDatabase:
    """Compute the static transmission error of a gear pair or a case.

    Parameters
    ----------
    subject : GearPair, InternalGearPair, Case, mapping or path
        A pair takes the keywords of `fe_contact.analyze`; a case states all of it, and takes `progress` and
        `workers`.

    Raises
    ------
    BadInput, InputError, InfeasibleGeometry
    """
    if isinstance(subject, ParallelAxes):
        return analyze_pair(subject, **options)
    case = CheckedCase(case_of(_source(subject)))
    _warn(case_warnings(case))
    return database_of(case, cache_home(), **options)


def simulate(
    subject: Scene | Subject,
    progress: Progress = silent,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> RunResult:
    """Run a scene: in SI, or as written, with the tables of its meshes computed first.

    Raises
    ------
    BadInput
        No such scene, or it does not move.
    JobFailed
        The run ended early; see `dynamics.simulation.simulate` for its states.
    """
    scene = subject if isinstance(subject, Scene) else tabled(subject, progress, workers).scene
    run = run_scene(scene)
    if not run.status.usable:
        raise JobFailed(f"The run ended early: {run.status.name.lower().replace('_', ' ')}.")
    return run


def tabled(
    subject: Subject,
    progress: Progress = silent,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> TabledScene:
    """Return a scene with the tables of its meshes, computed here, and its housings reduced."""
    return _tabled(*_scene(subject), progress, workers)


def _tabled(scene: SceneInput, folder: Path, progress: Progress, workers: Workers) -> TabledScene:
    _warn(left_out_warnings(scene.left_out))
    cases = CheckedCases()
    here = ComputedTables(lambda case: database_of(cases.of(case), cache_home(), progress, workers))
    tables = MeshTables(folder, here)
    return scene_by_tables(
        scene,
        folder,
        lambda index, mesh: finished(tables.of(index, mesh)),
        cache_home(),
        progress,
        _warn,
        cases,
    )


@dataclass(frozen=True)
class _StudyCall(Generic[Result]):
    """A study as a function; `name` is its row of `lineofaction.gearbox.registry`."""

    name: str

    @property
    def __doc__(self) -> str:  # type: ignore[override]
        """What the study does, and its inputs."""
        study = STUDIES[self.name]
        fields = study.inputs.model_fields.items()
        inputs = "".join(f"\n{name}: {field.description or ''}" for name, field in fields)
        return f"{study.description}\n{inputs}"

    def __call__(
        self,
        subject: Subject,
        inputs: Mapping[str, Any] | None = None,
        *,
        run: RunResult | None = None,
        workers: Workers = InProcess(),  # noqa: B008 (frozen)
        progress: Progress = silent,
        folder: Path | None = None,
        **fields: Any,
    ) -> Result:
        """Study a case, a scene or a unit.

        Parameters
        ----------
        inputs, fields
            What is varied, in the units of the names; `help` of the function lists it.
        run : RunResult, optional
            Whose bearing forces a study of housings takes.
        workers : Workers
            Who does the tasks.
        progress : callable
            Called as progress(stage, fraction).
        folder : Path, optional
            Where to put the runs that a study keeps.

        Returns
        -------
        object
            The result of the study, with errors and cost; `lineofaction.report` draws it.

        Raises
        ------
        BadInput, JobFailed
        """
        study = STUDIES[self.name]
        named = {} if run is None else {"run": content_digest(run)}
        varied = validated(study.inputs, {**named, **(inputs or {}), **fields})
        stated, files = self._stated(subject)
        chosen = study.run.narrowed(stated, varied)
        study.run.check(chosen, varied)
        made = chosen if isinstance(chosen, CheckedCase) else self._made(chosen, files, progress, workers)
        means = Means(cache_home(), progress, workers, folder=folder, run=run)
        result: Result = study.run.compute(made, varied, means)
        _warn(study.run.warnings(result) or ())
        if failure := study.run.failure(result):
            raise JobFailed(failure)
        return result

    def _made(
        self, scene: SceneInput, folder: Path, progress: Progress, workers: Workers
    ) -> TabledScene | HousedScene:
        """Return a scene with its tables, or only with its housings, as the study takes it."""
        if STUDIES[self.name].run.tables:
            return _tabled(scene, folder, progress, workers)
        _warn(left_out_warnings(scene.left_out))
        return HousedScene(scene, housings_in(scene, cache_home(), folder, progress))

    def _stated(self, subject: Subject) -> tuple[CheckedCase | SceneInput, Path]:
        """Return what is studied as written, and the folder of its files."""
        kind = STUDIES[self.name].subject
        if kind == "scene" or (kind != "case" and _has_shafts(subject)):
            return _scene(subject)
        case = CheckedCase(case_of(_source(subject)))
        _warn(case_warnings(case))
        return case, Path()


def _scene(subject: Any) -> tuple[SceneInput, Path]:
    """Return a scene and what its files are relative to; that of a unit has its cases written out."""
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
    """Warn of what is implausible, each once."""
    for warning in findings:
        warnings.warn(warning["message"], InputWarning, stacklevel=4)


if TYPE_CHECKING:

    def _function(study: Computation[Any, Any, Any, Any, Result]) -> _StudyCall[Result]: ...

    flank = _function(FLANK)
    ablate = _function(ABLATE)
    frontier = _function(FRONTIER)
    sensitivity = _function(SENSITIVITY)
    root_stress = _function(ROOT_STRESS)
    optimize = _function(OPTIMIZE)
    scatter = _function(SCATTER)
    sweep = _function(SWEEP)
    modes = _function(MODES)
    response = _function(RESPONSE)
    noise = _function(NOISE)
    vibration = _function(VIBRATION)
    listen = _function(LISTEN)
    steady = _function(STEADY)
    deflect = _function(DEFLECT)
    study = _function(STUDY)
else:
    globals().update({study.package: _StudyCall(name) for name, study in STUDIES.items()})
