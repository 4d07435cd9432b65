"""A folder as the project: which of its files a verb takes, where its results lie, and which are out of date.

A file is known by what it holds, not by its name: a scene has shafts, a case a pair, the file of a study
nothing but fields of that study. Files of other content are left alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES, SUFFIX
from lineofaction.gearbox.schemas.reading import read_model, read_table
from lineofaction.gearbox.study import Study

if TYPE_CHECKING:
    from lineofaction.gearbox.schemas.scene import SceneInput

_SIGNS = {"scene": "shafts", "case": "pair"}
_ENDINGS = (".toml", ".json")
RUN, SOUND = f"run{SUFFIX}", "run.wav"
"""Names of the files of a scene's run and of its sound in a project."""

Named = TypeVar("Named", InputFile, Path)


def file_of(file: InputFile, subject: str) -> InputFile:
    """Return a named file, or of a folder the only file that holds a `subject` of the study.

    For "case or scene" the scene goes first. Of several scenes the one named ``scene.toml`` is taken, of
    several cases ``case.toml``. Raises `BadInput`: the folder holds no such file, or several of other names.
    """
    return sole_file(files_of(file, subject), file.path, subject)


def files_of(file: InputFile, subject: str) -> list[InputFile]:
    """Return the file of `file_of`, or all cases of a folder that has several.

    Raises `BadInput`: the folder holds no such file, or several scenes of other names.
    """
    if not file.path.is_dir():
        return [file]
    for kind in _SIGNS:
        if kind not in subject:
            continue
        chosen = _chosen(dict(_tables(file.path)), kind)
        if len(chosen) == 1:
            return [InputFile(chosen[0], file.overrides, file.path)]
        files = [InputFile(path, file.overrides, file.path, path.stem) for path in chosen]
        if files:
            return files if kind == "case" else [sole_file(files, file.path, kind)]
    raise _none_of(file.path, str(file), subject)


def sole_file(files: Sequence[Named], project: Path, kind: str) -> Named:
    """Return the only file of a kind in a folder; raises `BadInput`: there are several."""
    if len(files) > 1:
        remedy = f"Name one: {_listed(files)}."
        raise BadInput.of(kind, str(project), f"a folder of one {kind}", remedy)
    return files[0]


def inputs_in(project: Path, study: Study) -> Path | None:
    """Return the file in a folder that holds inputs of a study, None if there is none.

    Raises `BadInput`: several do.
    """
    files = _inputs_in(project, study)
    return sole_file(files, project, f"file for {study.name}") if files else None


def _inputs_in(project: Path, study: Study) -> list[Path]:
    fields = study.inputs.model_fields.keys()
    return [path for path, table in _tables(project) if table and table.keys() <= fields]


def usual_speeds(scene: SceneInput, project: Path | None, count: int) -> list[float]:
    """Return `count` speeds in rpm, evenly up to the highest of the first drive and the folder's load cases.

    Raises `BadInput`: none of them has a speed, or load cases with a fault.
    """
    study = STUDIES["deflect"]
    files = [] if project is None else _inputs_in(project, study)
    deflected: list[Any] = [read_model(study.inputs, path) for path in files]
    speeds = [speed for drive in scene.drives[:1] for speed in drive.speed_rpm or ()]
    speeds += [case.speed_rpm or 0.0 for inputs in deflected for case in inputs.load_cases]
    highest = max(map(abs, speeds), default=0.0)
    if not highest:
        bound = "given where neither a drive nor a load case has a speed"
        raise BadInput.of("speed_rpm", None, bound, "For example --speed-rpm 500:6000:100.")
    return [highest * (k + 1) / count for k in range(count)]


def results_in(project: Path) -> list[Path]:
    """Return the results in a folder and in the folders that studies wrote into it."""
    return [*sorted(project.glob(f"*{SUFFIX}")), *sorted(project.glob(f"*/*{SUFFIX}"))]


def results_by_part(project: Path) -> dict[str, list[Path]]:
    """Return the results in a folder by the case whose name they bear; others by an empty text.

    The results of a single case do not bear its name.
    """
    cases = [path.stem for path in _chosen(dict(_tables(project)), "case")]
    parts = cases if len(cases) > 1 else []
    by_part: dict[str, list[Path]] = {part: [] for part in ("", *parts)}
    for path in results_in(project):
        name = path.relative_to(project).with_suffix("").as_posix()
        owners = (part for part in parts if name == part or name.startswith(f"{part}_"))
        by_part[max(owners, key=len, default="")].append(path)
    return {part: paths for part, paths in by_part.items() if paths}


def tables_in(named: Path, cached: Callable[[Path], Path]) -> dict[str, Path | None]:
    """Return a named table, or of a folder the table of each case by name: its file, else a `cached` one.

    A case without either has None. Raises `BadInput`: no case has a table.
    """
    if not named.is_dir():
        return {"": named}
    tables = {}
    for case in _chosen(dict(_tables(named)), "case"):
        table = named / f"{case.stem}{SUFFIX}"
        if not table.is_file():
            table = cached(case)
        tables[case.stem] = table if table.is_file() else None
    if not any(tables.values()):
        remedy = f"Make them with: loa analyze {named}"
        raise BadInput.of("file", str(named), "a folder with an STE database in it", remedy)
    return tables


def run_in(named: Path) -> Path:
    """Return the file of a run: the named file, or the file of the run in a named folder."""
    return named / RUN if named.is_dir() else named


def about(project: Path) -> Path | None:
    """Return the file in a folder with the table ``[report]``: ``report.toml``, the scene, or the only one.

    Raises `BadInput`: several of other names have one.
    """
    reports = [path for path, table in _tables(project) if "report" in table]
    first = [path for name in ("report", "scene") for path in reports if path.stem == name]
    if len(reports) > 1 and not first:
        remedy = f"Name one: {_listed(reports)}."
        raise BadInput.of("--about", str(project), "a folder of one [report]", remedy)
    return next(iter(first or reports), None)


@dataclass(frozen=True)
class ResultState:
    """A result of a folder."""

    name: str
    verb: str
    """`name`, `verb`: Name of the file relative to the folder, and the verb that writes the file."""
    state: str
    """Stale: a file of the folder that says what is computed is newer."""
    source: Path | None = None
    """The case or scene that it is of; None: not known."""


def status_of(project: Path) -> list[ResultState]:
    """Return the state of every result that the folder has a subject for, then of its other results.

    Raises `BadInput`: the folder has neither a case nor a scene.
    """
    tables = dict(_tables(project))
    subjects = [kind for kind in _SIGNS if _chosen(tables, kind)]
    if not subjects:
        raise _none_of(project, str(project), "case or scene")
    newest = max(path.stat().st_mtime for path in tables)
    expected = _expected(tables)
    names = (path.relative_to(project).as_posix() for path in results_in(project))
    states = []
    for name in dict.fromkeys([*expected, *names]):
        verb, source = expected.get(name, ("analyze", None))
        states.append(ResultState(name, verb, _state(project / name, newest), source))
    return states


def _expected(tables: Mapping[Path, Mapping[str, Any]]) -> dict[str, tuple[str, Path | None]]:
    """Return the verb and the subject of every result that the files have a subject for, by its name."""
    cases, scenes = (_chosen(tables, kind) for kind in ("case", "scene"))
    expected: dict[str, tuple[str, Path | None]] = {
        f"{case_path.stem}{SUFFIX}": ("analyze", case_path) for case_path in cases
    }
    if scenes:
        expected |= {RUN: ("simulate", scenes[0]), SOUND: ("listen", scenes[0])}
    file_verbs = {verb for verb, _ in expected.values()}
    for study in STUDIES.values():
        if study.name in file_verbs:
            continue
        if scenes and "scene" in study.takes.subject:
            expected[result_name(study)] = study.name, scenes[0]
        elif cases and "case" in study.takes.subject:
            several = len(cases) > 1 and not study.several
            for case in cases if several else cases[:1]:
                expected[result_name(study, case.stem if several else "")] = study.name, case
    return expected


def _state(result: Path, newest: float) -> str:
    if not result.exists():
        return "missing"
    return "stale" if result.stat().st_mtime < newest else "fresh"


def result_name(study: Study, part: str = "") -> str:
    """Return the file of a study's result relative to its project; `part` is that of its `InputFile`."""
    prefix = f"{part}_" if part else ""
    file = f"{study.folder}/{study.folder}" if study.folder else study.name
    return f"{prefix}{file}{SUFFIX}"


def _chosen(tables: Mapping[Path, Mapping[str, Any]], kind: str) -> list[Path]:
    """Return the files of a kind, the one of that name alone if there is one."""
    paths = [path for path, table in tables.items() if _SIGNS[kind] in table]
    return [path for path in paths if path.stem == kind] or paths


def unread_in(project: Path) -> list[BadInput]:
    """Return the errors of files in a folder that may hold a table and cannot be read."""
    return [content for _, content in _contents(project) if isinstance(content, BadInput)]


def _tables(project: Path) -> Iterator[tuple[Path, dict[str, Any]]]:
    """Yield the files of a folder that hold a table."""
    for path, content in _contents(project):
        if isinstance(content, dict):
            yield path, content


def _contents(project: Path) -> Iterator[tuple[Path, dict[str, Any] | BadInput]]:
    for path in sorted(project.iterdir()):
        if path.suffix in _ENDINGS and path.is_file():
            try:
                yield path, read_table(path)
            except BadInput as unread:
                yield path, unread


def _none_of(project: Path, named: str, kind: str) -> BadInput:
    """Return the error of a folder that holds no file of a kind; one that cannot be read might be it."""
    none = BadInput.of("file", named, f"a folder with a {kind} file in it", "Make one with: loa new")
    unread = [fault for error in unread_in(project) for fault in error.faults]
    return BadInput([*none.faults, *unread])


def _listed(paths: Iterable[Path | InputFile]) -> str:
    return ", ".join(map(str, paths))
