"""Result files: which study or kind each holds, read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from dynamics.errors import DynamicsError
from dynamics.results import RunResult
from fe_contact.errors import FeContactError
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.result_files import stamped
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES, Study
from lineofaction.report.drawing.page import Page
from lineofaction.report.presentation import presentation_of
from lineofaction.report.runs.run_view import RunView
from model_studies.netcdf import UnreadableFile, opened_netcdf


def stored_study(attributes: Mapping[str, object]) -> Study | None:
    """Return the study that made a file with these attributes; None: another kind of file."""
    return next((study for study in STUDIES.values() if study.run.file.holds(attributes)), None)


def study_page(study: Study, file: Path, database: SteDatabase | None = None) -> Page:
    """Return the page of a study's file; beside a database, if there is one.

    Raises
    ------
    BadInput
        It is damaged.
    """
    return page_beside(study, read_stored(study, file), database)


def read_stored(study: Study, file: Path) -> Any:
    """Return the result in a study's file.

    Raises
    ------
    BadInput
        It is damaged.
    """
    with _undamaged(study, file):
        return study.run.file.read(file)


@contextmanager
def _undamaged(study: Study, file: Path) -> Iterator[None]:
    """Name the file in the libraries' errors of damaged files."""
    try:
        yield
    except (FeContactError, DynamicsError) as error:
        raise BadInput.of("file", str(file), f"an undamaged {study.kind}", f"{error}.") from None
    except ValueError:
        advice = "Something is missing or not as written."
        raise BadInput.of("file", str(file), f"an undamaged {study.kind}", advice) from None


def page_beside(study: Study, found: object, database: SteDatabase | None) -> Page:
    """Return the page of a study's result; beside a database, if there is one."""
    presentation = presentation_of(study)
    if database is None or presentation.beside is None:
        return presentation.page(found)
    return presentation.beside(found, database)


# What a report is made from: a database, studies, a run; the files say which they are.


_BOUND = f"an STE database, a run, or the result of a study ({', '.join(STUDIES)})"
_READERS: dict[str, tuple[tuple[str, str], Callable[[Path], Any]]] = {
    "database": (("format", "lineofaction STE database"), SteDatabase.from_netcdf),
    "run": (("schema", "lineofaction dynamics run"), RunResult.from_netcdf),
}
"""Attribute of the file, and what reads it."""


@dataclass(frozen=True)
class Inputs:
    """The results that were read; at least one of them.

    `pages` are those of studies, by the kind of their results; `warnings` are those of all files, in words;
    `view` is what of the run is shown.
    """

    database: SteDatabase | None = None
    run: RunResult | None = None
    pages: Mapping[str, Page] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    view: RunView = field(default_factory=RunView)

    @property
    def only_page(self) -> Page | None:
        """The page of a study, if nothing else was read."""
        alone = len(self.pages) == 1 and self.database is None and self.run is None
        return next(iter(self.pages.values())) if alone else None


def read_inputs(files: Sequence[Path]) -> Inputs:
    """Read every file as what it says it is.

    Raises
    ------
    BadInput
        A file is neither, is damaged, there are two of a kind, or there is none at all.
    """
    if not files:
        raise BadInput.of("file", None, _BOUND, "Name at least one file.")
    by_kind: dict[str, tuple[Study | None, Path]] = {}
    for file in files:
        study, kind = _kind(file)
        if kind in by_kind:
            advice = "One page shows one file of each kind."
            raise BadInput.of("file", str(file), f"the only {kind}", advice)
        by_kind[kind] = study, file
    warnings = tuple(dict.fromkeys(one["message"] for file in files for one in stamped(file)))
    read = {kind: _read(file, kind) for kind, (study, file) in by_kind.items() if study is None}
    database = read.get("database")
    studies = sorted(
        ((study, file) for study, file in by_kind.values() if study is not None),
        key=lambda pair: list(STUDIES).index(pair[0].name),
    )
    pages = {study.kind: study_page(study, file, database) for study, file in studies}
    return Inputs(**read, pages=pages, warnings=warnings)


def read_result(file: Path) -> SteDatabase | RunResult:
    """Read a table or a run.

    Raises
    ------
    BadInput
        The file is neither, or is damaged.
    """
    study, kind = _kind(file)
    if study is not None:
        raise BadInput.of("result", f"{file.name}, which holds {kind}", "an STE database or a run")
    result: SteDatabase | RunResult = _read(file, kind)
    return result


def read_run(file: Path, field: str) -> RunResult:
    """Read a run, which `field` names.

    Raises
    ------
    BadInput
        The file is none, or is damaged.
    """
    result = read_result(file)
    if not isinstance(result, RunResult):
        raise BadInput.of(field, str(file), "a run", "It holds an STE database: loa simulate makes runs.")
    return result


def _kind(file: Path) -> tuple[Study | None, str]:
    """Return the study that made a file, if one did, and the kind of the file."""
    attributes = file_attributes(file)
    for kind, ((name, value), _) in _READERS.items():
        if attributes.get(name) == value:
            return None, kind
    if (study := stored_study(attributes)) is not None:  # loads what computes studies
        return study, study.kind
    raise BadInput.of("file", str(file), _BOUND, "It is a netCDF file of another kind.")


def file_attributes(file: Path) -> dict[str, str]:
    """Return the attributes of a netCDF file as texts.

    Raises
    ------
    BadInput
        The file is missing or no netCDF-4 file.
    """
    if not file.is_file():
        raise BadInput.of("file", str(file), _BOUND, "There is no such file. Check the path.")
    if file.suffix == ".json":
        advice = "JSON is for programs. Name the netCDF file: the verb writes it with -o FILE.nc."
        raise BadInput.of("file", str(file), _BOUND, advice)
    try:
        with opened_netcdf(file) as content:
            return {name: str(value) for name, value in content.attrs.items()}
    except UnreadableFile as error:
        raise BadInput.of("file", str(file), _BOUND, f"{error}.") from None


def _read(file: Path, kind: str) -> Any:
    try:
        return _READERS[kind][1](file)
    except (FeContactError, DynamicsError) as error:
        raise BadInput.of("file", str(file), f"an undamaged {kind}", f"{error}.") from None
