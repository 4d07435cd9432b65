"""Files of every kind by one function: inputs, gear units, results, recordings, numbers, folders."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar, overload

from bounds.brief import MAX_LINES, Row, brief
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES, SUFFIX
from lineofaction.gearbox.schemas import read_table
from lineofaction.gearbox.signals.endings import FORMATS
from lineofaction.gearbox.study import StudyFunction
from lineofaction.gearbox.workbench import open_unit
from lineofaction.gearbox.workbench import read as read_input

if TYPE_CHECKING:
    import pandas

    from bounds.plottable import Plottable
    from dynamics.results import RunResult
    from fe_contact.ste import SteDatabase
    from lineofaction.gearbox.from_rexs.opened import OpenedUnit
    from lineofaction.gearbox.schemas import Case
    from lineofaction.gearbox.schemas.scene import SceneInput
    from lineofaction.gearbox.signals.recording import Recording

    # results of studies: Plottable
    Input: TypeAlias = Case | SceneInput
    Content: TypeAlias = (
        Input
        | OpenedUnit
        | SteDatabase
        | RunResult
        | Plottable
        | Recording
        | pandas.DataFrame
        | dict[str, Any]
        | "Folder"
    )

UNITS = (".rexs", ".rexsj", ".rexsz", ".rexs.zip")
"""Endings of gear units."""
_TABLES = (".toml", ".json")
_SUBJECTS = {"pair": "case", "shafts": "scene"}
"""Kind of an input by the table that identifies it."""


T = TypeVar("T")


@overload
def read(file: Path | str, overrides: Mapping[str, object] | None = None, *, kind: type[T]) -> T: ...
@overload
def read(
    file: Path | str, overrides: Mapping[str, object] | None = None, *, kind: StudyFunction[..., T]
) -> T: ...
@overload
def read(file: Path | str, overrides: Mapping[str, object], *, kind: None = None) -> Input: ...
@overload
def read(file: Path | str, overrides: None = None, *, kind: None = None) -> Content: ...
def read(
    file: Path | str,
    overrides: Mapping[str, object] | None = None,
    *,
    kind: type[Any] | StudyFunction[..., Any] | None = None,
) -> Any:
    """Read a file that `loa` takes or writes, or a folder of them.

    Raises `BadInput`: the file is missing, damaged or of another kind.

    Parameters
    ----------
    file : path
        Case or scene (TOML or JSON; what has shafts is a scene), inputs of a study (TOML), figures of a
        result (JSON), gear unit (REXS), result (netCDF), recording (CSV that begins with a time, WAV,
        universal file and others), table of numbers (CSV), or a folder.
    overrides : mapping of str to object, optional
        Values over those of a case or a scene by their paths, as ``{"loads.brake.torque_n_m": 40}``.
    kind : class or study, optional
        Class of the content, as ``loa.SteDatabase``, or the study that made it, as ``loa.modes``. Another
        content is refused, and editors and type checkers know what is returned.

    Returns
    -------
    Case, SceneInput, dict, OpenedUnit, SteDatabase, RunResult, the result of a study, Recording, DataFrame of
    pandas or `Folder`
    """
    path = Path(file)
    content = _content(path, overrides)
    if kind is not None:
        _check_kind(path, content, kind)
    return content


def _content(path: Path, overrides: Mapping[str, object] | None) -> Any:
    """Return what a file holds; raises `BadInput`: overrides of what is neither case nor scene."""
    reader = _reader(path)
    if not overrides:
        return reader(path)
    if reader is not _read_table:
        remedy = "Leave them out; loa.open_unit takes those of the scene of a unit."
        raise BadInput.of("overrides", ", ".join(overrides), "those of a case or a scene", remedy)
    return read_input(path, overrides)


def _check_kind(path: Path, content: object, kind: type[Any] | StudyFunction[..., Any]) -> None:
    """Raise `BadInput` unless a content is of a class, or of the class that a study returns."""
    if isinstance(kind, StudyFunction):
        expected, name = kind.study.run.file.result, f"loa.{kind.study.package}"
    else:
        expected, name = kind, kind.__name__
    if not isinstance(content, expected):
        bound = f"the kind of {path.name}, which holds {type(content).__name__}"
        raise BadInput.of("kind", name, bound, "Leave it out to read any kind.")


def _reader(path: Path) -> Callable[[Path], Any]:
    """Return the reader of a file by its ending."""
    if path.is_dir():
        return Folder
    if path.name.lower().endswith(UNITS):
        return open_unit
    ending = path.suffix.lower()
    if ending == ".csv":
        return _read_csv
    return {SUFFIX: _read_result, ".nc4": _read_result, **dict.fromkeys(FORMATS, _read_signals)}.get(
        ending, _read_table
    )


def _read_result(path: Path) -> Any:
    from lineofaction.report.document import read_file  # noqa: PLC0415 (start-up time: it draws)

    return read_file(path)


def _read_signals(path: Path) -> Any:
    from lineofaction.gearbox.signals.recording import read_recording  # noqa: PLC0415 (start-up time)

    return read_recording(path, "file")


def _read_csv(path: Path) -> Any:
    """Return a recording if the file begins with a time, else a table of pandas, with or without a head."""
    from lineofaction.gearbox.signals.recording import begins_with_time  # noqa: PLC0415 (start-up time)

    if not path.is_file():
        raise BadInput.of("file", str(path), "a readable file", "Check the path.")
    if begins_with_time(path):
        return _read_signals(path)
    from host.optional_modules import pandas  # noqa: PLC0415 (read_csv alone needs it)

    try:
        first = pandas.read_csv(path, nrows=1, header=None, dtype=str).iloc[0]
        numbers = pandas.to_numeric(first, errors="coerce").notna().all()
        return pandas.read_csv(path, header=None if numbers else 0)
    except (ValueError, UnicodeDecodeError) as error:
        raise BadInput.of("file", str(path), "a table as CSV", f"{error}.") from None


def _read_table(path: Path) -> Any:
    """Return a case, a scene, the inputs of a study, or figures that a study wrote."""
    table = read_table(path)
    is_figures = path.suffix == ".json" and not _SUBJECTS.keys() & table.keys()
    return table if is_figures or _is_study(table) else read_input(path)


def _is_study(table: Mapping[str, Any]) -> bool:
    """Whether a table has nothing but inputs of one study."""
    if not table or _SUBJECTS.keys() & table.keys():
        return False
    return any(table.keys() <= study.inputs.model_fields.keys() for study in STUDIES.values())


@brief
@dataclass(frozen=True)
class Folder(Mapping[str, Any]):
    """The files of a folder that `read` takes, by their names; each is read on its request.

    Files of the folders in it, as studies write them, have the name of their folder before theirs.
    """

    path: Path

    def __getitem__(self, name: str) -> Any:
        if name not in self.files:
            raise KeyError(name)
        return read(self.files[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self.files)

    def __len__(self) -> int:
        return len(self.files)

    @property
    def files(self) -> dict[str, Path]:
        """The paths of the files by their names."""
        readable = (*UNITS, *_TABLES, SUFFIX, *FORMATS)
        paths = sorted((*self.path.glob("*"), *self.path.glob("*/*")))
        return {
            path.relative_to(self.path).as_posix(): path
            for path in paths
            if path.is_file() and path.name.lower().endswith(readable)
        }

    def headlines(self) -> tuple[str, list[Row]]:
        """Return the title and the kinds of the first files."""
        files = self.files
        kinds = [_kind(path) for path in list(files.values())[:MAX_LINES]]
        rows = [*zip(files, kinds, strict=False), *((name, "") for name in list(files)[MAX_LINES:])]
        return f"Folder {self.path.name or self.path}: {len(files)} files", rows


def _kind(path: Path) -> str:
    """Return the kind of a file in words, without reading it whole."""
    reader = _reader(path)
    if reader is not _read_table:
        return {open_unit: "gear unit", _read_result: "result", _read_csv: "CSV"}.get(reader, "recording")
    try:
        table = read_table(path)
    except BadInput:
        return "not readable"
    return next((kind for sign, kind in _SUBJECTS.items() if sign in table), "inputs or figures of a study")
