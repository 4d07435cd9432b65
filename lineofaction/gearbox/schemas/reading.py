"""Case and scene files from disk: TOML, or JSON of the same shape."""

from __future__ import annotations

from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.fault_lines import located
from lineofaction.gearbox.schemas.faults import faults_of
from lineofaction.gearbox.schemas.files import READERS, written_out
from lineofaction.gearbox.schemas.named_files import in_folder, read_text
from lineofaction.gearbox.schemas.toml import toml_table
from lineofaction.gearbox.shallow_json import shallow_json

M = TypeVar("M", bound=BaseModel)
_SIGNS = {
    "pair": ("a case (with [pair])", "loa analyze and its like take it"),
    "shafts": ("a scene (with [[shafts]])", "loa simulate and its like take it"),
}
"""Content of a file and the verbs that take it, by the table that identifies the file."""


def validated(model: type[M], data: object) -> M:
    """Return `data` as `model`.

    Raises `BadInput`: with every fault of the data.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise BadInput(faults_of(error, model)) from None


def read_table(source: Path | InputFile) -> dict[str, Any]:
    """Return the table a TOML or JSON file holds, with the values set over it.

    Raises `BadInput`: the file is missing, too large, no text, or not well formed, or it has no place for a
    value.
    """
    file = InputFile.of(source)
    path, text = file.path, read_text(file.path, str(file.path))
    table = _json(text, str(path)) if path.suffix == ".json" else toml_table(text, str(path))
    if not isinstance(table, dict):
        raise BadInput.of(str(path), table, "a table of fields", "See docs/case-file.md.")
    return file.applied(table)


def _json(text: str, field: str) -> Any:
    try:
        return shallow_json(text)
    except ValueError as error:  # of JSON, or of a number with too many digits
        raise BadInput.of(field, None, "well-formed JSON", f"{error}.") from None
    except RecursionError:
        raise BadInput.of(field, None, "JSON of less depth", "See docs/case-file.md.") from None


def _check_kind(model: type[BaseModel], table: dict[str, Any], path: Path) -> None:
    """Refuse a case given as a scene, or a scene given as a case, by that one fault."""
    expected = [sign for sign in _SIGNS if sign in model.model_fields]
    present = [sign for sign in _SIGNS if sign in table]
    if expected and present and not set(expected) & set(present):
        content, takers = _SIGNS[present[0]]
        raise BadInput.of("file", str(path), _SIGNS[expected[0]][0], f"It holds {content}: {takers}.")


def read_model(model: type[M], source: Path | InputFile) -> M:
    """Return a file as `model`.

    Raises `BadInput`: the file, or a flank grid or housing it names, cannot be read, it is a case instead of
    a scene (or the other way round), or with every fault of its contents.
    """
    file = InputFile.of(source)
    table = read_table(file)
    _check_kind(model, table, file.path)
    with located(file):
        return validated(model, written_out(table, in_folder(file.folder), READERS))
