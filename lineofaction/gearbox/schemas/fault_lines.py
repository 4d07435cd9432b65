"""Lines of fields in TOML files, for messages about a fault."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput, Fault

_HEADER = re.compile(r"^\s*(\[\[?)\s*([^\[\]#]+?)\s*\]\]?")
_KEY = re.compile(r"""^\s*((?:[\w-]+|"[^"\n]*"|'[^'\n]*')(?:\s*\.\s*(?:[\w-]+|"[^"\n]*"|'[^'\n]*'))*)\s*=""")


@contextmanager
def located(file: InputFile) -> Iterator[None]:
    """Name file and line in the faults of a file; a value that was set over the file has no line."""
    try:
        yield
    except BadInput as error:
        raise BadInput(_placed_fault(fault, file) for fault in error.faults) from None


def line_of_field(text: str, field: str) -> int | None:
    """Return the line, from 1, at which a field of a TOML text or else the table around it begins.

    None if neither is there. Values of several lines count as one, inline tables too.
    """
    lines = dict(_lines(text))
    while field:
        if field in lines:
            return lines[field]
        # the table around it; a dot or bracket at the end belongs to a name in quotes
        field = re.sub(r"(\[\d+\]|\.?[^.\[\]]+|[.\[\]])\Z", "", field)
    return None


def _placed_fault(fault: Fault, file: InputFile) -> Fault:
    """Return a fault with its place, if it has none and the file is TOML that holds it."""
    part = fault.field.partition("[")[0]
    if fault.location or file.path.suffix == ".json" or any(o.path.startswith(part) for o in file.overrides):
        return fault
    try:
        line = line_of_field(file.path.read_text(encoding="utf-8"), fault.field)
    except (OSError, UnicodeDecodeError):
        return fault
    return fault if line is None else replace(fault, location=f"{file.path}:{line}")


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
