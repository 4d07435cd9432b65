"""Case and scene files from disk: TOML, or JSON of the same shape, with the lines of faults."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput, Fault
from lineofaction.gearbox.schemas.faults import faults_of
from lineofaction.gearbox.schemas.files import READERS, beside, read_text, written_out
from lineofaction.gearbox.schemas.toml import toml_table

M = TypeVar("M", bound=BaseModel)
_SIGNS = {
    "pair": ("a case (with [pair])", "loa analyze and its like take it"),
    "shafts": ("a scene (with [[shafts]])", "loa simulate and its like take it"),
}
"""The table by which a file is known: what it holds, and who takes it."""
_HEADER = re.compile(r"^\s*(\[\[?)\s*([^\[\]#]+?)\s*\]\]?")
_KEY = re.compile(r"""^\s*((?:[\w-]+|"[^"\n]*"|'[^'\n]*')(?:\s*\.\s*(?:[\w-]+|"[^"\n]*"|'[^'\n]*'))*)\s*=""")


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
        return json.loads(text)
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
        return validated(model, written_out(table, beside(file.folder), READERS))


# Where in its file a field stands: the line that a fault is about.


@contextmanager
def located(file: InputFile) -> Iterator[None]:
    """Name file and line in the faults of what is read from it; a value that was set stands in no line."""
    try:
        yield
    except BadInput as error:
        raise BadInput(_placed(fault, file) for fault in error.faults) from None


def line_of_field(text: str, field: str) -> int | None:
    """Return the line, from 1, at which a field of a TOML text or else the table around it begins.

    None if neither is there. Values of several lines count as one, inline tables too.
    """
    lines = dict(_lines(text))
    while field:
        if field in lines:
            return lines[field]
        field = re.sub(r"(\[\d+\]|\.?[^.\[\]]+)$", "", field)
    return None


def _placed(fault: Fault, file: InputFile) -> Fault:
    """Return a fault with its place, if it has none and the file is TOML that holds it."""
    own = fault.field.partition("[")[0]
    if fault.place or file.path.suffix == ".json" or any(o.path.startswith(own) for o in file.overrides):
        return fault
    try:
        line = line_of_field(file.path.read_text(encoding="utf-8"), fault.field)
    except (OSError, UnicodeDecodeError):
        return fault
    return fault if line is None else replace(fault, place=f"{file.path}:{line}")


def _lines(text: str) -> Iterator[tuple[str, int]]:
    """Yield the fields and tables of a TOML text with their lines."""
    table, counts, depth, quoted = "", Counter[str](), 0, ""
    for number, line in enumerate(text.splitlines(), start=1):
        if not quoted and depth <= 0:
            if header := _HEADER.match(line):
                table = _table(header, counts)
                yield table, number
            elif key := _KEY.match(line):
                yield f"{table}.{key[1]}".lstrip("."), number
        quoted = _open_quote(line, quoted)
        if not quoted and not _HEADER.match(line):
            bare = re.sub(r"\"[^\"]*\"|'[^']*'|#.*", "", line)
            depth += bare.count("[") - bare.count("]")


def _table(header: re.Match[str], counts: Counter[str]) -> str:
    """Return the name of a table with the indices of the lists it is in."""
    names = [name.strip() for name in header[2].split(".")]
    path = ""
    for index, name in enumerate(names):
        path = f"{path}.{name}".lstrip(".")
        if header[1] == "[[" and index == len(names) - 1:
            counts[path] += 1
        if counts[path]:
            path += f"[{counts[path] - 1}]"
    return path


def _open_quote(line: str, quoted: str) -> str:
    """Return the quotes of a text of several lines that is open at the end of a line; empty for none."""
    marks = [quoted] if quoted else ['"""', "'''"]
    for mark in marks:
        if line.count(mark) % 2:
            return "" if quoted else mark
    return quoted
