"""A folder as the project: which of its files a verb takes, where its results lie, and which are out of date.

A file is known by what it holds, not by its name: a scene has shafts, a case a pair, the file of a study
nothing but fields of that study. Files of other content are left alone.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES, SUFFIX
from lineofaction.gearbox.schemas.reading import read_table
from lineofaction.gearbox.study import Study

_SIGNS = {"scene": "shafts", "case": "pair"}
_ENDINGS = (".toml", ".json")


def file_of(named: InputFile, subject: str) -> InputFile:
    """Return a file as it is named, of a folder the one in it that holds what is studied.

    Parameters
    ----------
    subject : "case", "scene" or "case or scene"
        Of the latter the scene goes first. Of several files the one of that name (``scene.toml``) is taken.

    Raises
    ------
    BadInput
        The folder holds no such file, or several of other names.
    """
    if not named.path.is_dir():
        return named
    kinds = [kind for kind in _SIGNS if kind in subject]
    tables = dict(_tables(named.path))
    for kind in kinds:
        found = [path for path, table in tables.items() if _SIGNS[kind] in table]
        chosen = [path for path in found if path.stem == kind] or found
        if len(chosen) == 1:
            return InputFile(chosen[0], named.overrides, named.path)
        if chosen:
            raise BadInput.of(kind, str(named), f"a folder of one {kind}", f"Name one: {_listed(chosen)}.")
    raise BadInput.of("file", str(named), f"a folder with a {subject} file in it", "Make one with: loa new")


def inputs_in(project: Path, study: Study) -> Path | None:
    """Return the file in a folder that holds inputs of a study, None if there is none.

    Raises `BadInput`: several do.
    """
    fields = study.inputs.model_fields.keys()
    found = [path for path, table in _tables(project) if table and table.keys() <= fields]
    if len(found) > 1:
        advice = f"Name one: {_listed(found)}."
        raise BadInput.of("study", str(project), f"a folder of one file for {study.name}", advice)
    return found[0] if found else None


def results_in(project: Path) -> list[Path]:
    """Return the results in a folder and in those that studies wrote into it."""
    return [*sorted(project.glob(f"*{SUFFIX}")), *sorted(project.glob(f"*/*{SUFFIX}"))]


def about(project: Path) -> Path | None:
    """Return the file in a folder with the table ``[report]``: ``report.toml``, the scene, or the only one.

    Raises `BadInput`: several of other names have one.
    """
    found = [path for path, table in _tables(project) if "report" in table]
    chosen = [path for name in ("report", "scene") for path in found if path.stem == name] or found
    if len(chosen) > 1 and chosen == found and not {"report", "scene"} & {path.stem for path in found}:
        raise BadInput.of("--about", str(project), "a folder of one [report]", f"Name one: {_listed(found)}.")
    return chosen[0] if chosen else None


@dataclass(frozen=True)
class ResultState:
    """A result of a folder.

    Attributes
    ----------
    name, verb : str
        Of the file, relative to the folder, and of the verb that makes it.
    state : "fresh", "stale" or "missing"
        Stale: a file of the folder that says what is computed is newer.
    """

    name: str
    verb: str
    state: str


def status_of(project: Path) -> list[ResultState]:
    """Return the state of the run and of every study that the folder has a subject for, then of the rest.

    Raises `BadInput`: the folder has neither a case nor a scene.
    """
    tables = dict(_tables(project))
    subjects = [kind for kind, sign in _SIGNS.items() if any(sign in table for table in tables.values())]
    if not subjects:
        raise BadInput.of(
            "file", str(project), "a folder with a case or scene file in it", "Make one: loa new"
        )
    newest = max(path.stat().st_mtime for path in tables)
    expected = {} if "scene" not in subjects else {f"run{SUFFIX}": "simulate"}
    for study in STUDIES.values():
        if any(kind in study.takes.subject for kind in subjects):
            expected[result_name(study)] = study.name
    found = {path.relative_to(project).as_posix(): path for path in results_in(project)}
    names = dict.fromkeys([*expected, *found])
    states = {
        name: "missing" if name not in found else "stale" if found[name].stat().st_mtime < newest else "fresh"
        for name in names
    }
    return [ResultState(name, expected.get(name, "analyze"), state) for name, state in states.items()]


def result_name(study: Study) -> str:
    """Return the file of a study's result in its project, relative to that."""
    return f"{study.folder}/{study.folder}{SUFFIX}" if study.folder else f"{study.name}{SUFFIX}"


def _tables(project: Path) -> Iterator[tuple[Path, dict[str, Any]]]:
    """Yield the files of a folder that hold a table; what cannot be read is no file of the project."""
    for path in sorted(project.iterdir()):
        if path.suffix in _ENDINGS and path.is_file():
            try:
                yield path, read_table(path)
            except BadInput:
                continue


def _listed(paths: Collection[Path]) -> str:
    return ", ".join(map(str, paths))
