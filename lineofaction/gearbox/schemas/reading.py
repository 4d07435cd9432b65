"""Case and scene files from disk: TOML, or JSON of the same shape."""

from __future__ import annotations

import json
from collections.abc import Collection
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.faults import faults_of
from lineofaction.gearbox.schemas.flank_grid_csv import with_flank_grids
from lineofaction.gearbox.schemas.housing_file import READERS, with_housing_files
from lineofaction.gearbox.schemas.lines import located
from lineofaction.gearbox.schemas.named_files import Find, beside
from lineofaction.gearbox.schemas.toml_table import toml_table

M = TypeVar("M", bound=BaseModel)

_LARGEST_FILE = 16_000_000


def validated(model: type[M], data: object) -> M:
    """Return `data` as `model`.

    Raises
    ------
    BadInput
        With every fault of the data.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise BadInput(faults_of(error, model)) from None


def read_table(source: Path | InputFile) -> dict[str, Any]:
    """Return the table a TOML or JSON file holds, with the values set over it.

    Raises
    ------
    BadInput
        The file is missing, too large, no text, or not well formed, or it has no place for a value.
    """
    file = InputFile.of(source)
    path, text = file.path, read_text(file.path, str(file.path))
    table = _json(text, str(path)) if path.suffix == ".json" else toml_table(text, str(path))
    if not isinstance(table, dict):
        raise BadInput.of(str(path), table, "a table of fields", "See docs/case-file.md.")
    return file.applied(table)


def _json(text: str, field: str) -> Any:
    """Return what a JSON text holds; raises `BadInput`."""
    try:
        return json.loads(text)
    except ValueError as error:  # of JSON, or of a number with too many digits
        raise BadInput.of(field, None, "well-formed JSON", f"{error}.") from None
    except RecursionError:
        raise BadInput.of(field, None, "JSON of less depth", "See docs/case-file.md.") from None


def read_text(path: Path, name: str) -> str:
    """Return the text of a file; raises `BadInput` with the name that its caller has for it."""
    try:
        if path.stat().st_size > _LARGEST_FILE:
            raise BadInput.of("file", name, f"at most {_LARGEST_FILE} bytes", "Is this the right file?")
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise BadInput.of("file", name, "a text file in UTF-8", "Is this the right file?") from None
    except OSError as error:
        reason = error.strerror or "unreadable"
        raise BadInput.of("file", name, "a readable file", f"{reason}. Check the path.") from None


_SIGNS = {
    "pair": ("a case (with [pair])", "loa analyze and its like take it"),
    "shafts": ("a scene (with [[shafts]])", "loa simulate and its like take it"),
}
"""The table by which a file is known: what it holds, and who takes it."""


def _check_kind(model: type[BaseModel], table: dict[str, Any], path: Path) -> None:
    """Refuse a case given as a scene, or a scene given as a case, by that one fault."""
    expected = [sign for sign in _SIGNS if sign in model.model_fields]
    present = [sign for sign in _SIGNS if sign in table]
    if expected and present and not set(expected) & set(present):
        content, takers = _SIGNS[present[0]]
        raise BadInput.of("file", str(path), _SIGNS[expected[0]][0], f"It holds {content}: {takers}.")


def read_model(model: type[M], source: Path | InputFile) -> M:
    """Return a file as `model`.

    Raises
    ------
    BadInput
        The file, or a flank grid or housing it names, cannot be read, it is a case instead of a scene (or the
        other way round), or with every fault of its contents.
    """
    file = InputFile.of(source)
    table = read_table(file)
    _check_kind(model, table, file.path)
    with located(file):
        return validated(model, written_out(table, beside(file.folder), READERS))


def written_out(table: dict[str, Any], find: Find, housings: Collection[str]) -> dict[str, Any]:
    """Return a table with the content of the flank grids and housings that it names as files.

    Parameters
    ----------
    table : dict
    find : callable
    housings : collection of str
        The fields of housings whose files are read, see `with_housing_files`.

    Raises
    ------
    BadInput
        A file is missing, or holds something else.
    """
    return with_housing_files(with_flank_grids(table, find, read_text), find, housings)
