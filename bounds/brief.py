"""Records in a dozen lines, as a Python prompt and a notebook show them.

`brief` gives a dataclass such a `repr`, its HTML for notebooks, and equality by content. Its lines are those
that the record states itself (`Headlined`), the main figures of its report (`Plottable`), or its fields:
numbers as they are, arrays by shape and range, records by type.
"""

from __future__ import annotations

import html
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from enum import Enum
from itertools import islice
from textwrap import wrap
from typing import Any, Protocol, TypeVar, runtime_checkable

import numpy as np

from bounds.content_equality import equal_content, equal_records, record_hash
from bounds.plottable import Plottable
from bounds.unit import engineering

MAX_LINES = 12
"""Lines of a record, its title among them."""
WIDTH = 100
"""Characters of a line, at most."""
LISTED = 6
"""Numbers or words of a sequence that are listed; longer ones are counted."""

_UNIT, _NO_BREAK = re.compile(r"(?<=\d) (?=[^\W\d]|[°%])"), "\u00a0"
"""Blank between a number and a word, and one that no line ends at."""
_INDENT = 4
"""Blanks before and after the name of a row."""
_NARROW = 40
"""Characters left for the text of a row, up to which it is cut, not wrapped."""

Record = TypeVar("Record")
Row = tuple[str, str]


@runtime_checkable
class Headlined(Protocol):
    """A record that gives the headlines of its brief form."""

    def headlines(self) -> tuple[str, list[Row]]:
        """Return the title, and rows of name and text that take the place of the fields."""


def brief(kind: type[Record]) -> type[Record]:
    """Give a dataclass the short text and HTML of its content, and equality by it; a decorator."""
    kind.__eq__ = equal_records  # type: ignore[method-assign]
    if kind.__hash__ is object.__hash__:  # by identity: equal records would have unequal ones
        kind.__hash__ = record_hash  # type: ignore[assignment, method-assign]
    kind.__repr__ = text_of  # type: ignore[method-assign]
    kind._repr_html_ = html_of  # type: ignore[attr-defined]
    return kind


def concise(kind: type[Record]) -> type[Record]:
    """Give a dataclass the `repr` of a call without the arguments that have their defaults; a decorator."""
    kind.__repr__ = call_of  # type: ignore[method-assign]
    return kind


def call_of(record: object) -> str:
    """Return the call that makes a dataclass, without the arguments that have their defaults."""
    arguments = (
        f"{field.name}={value!r}"
        for field in fields(record)  # type: ignore[arg-type]
        if field.init
        and field.repr
        and not equal_content(value := getattr(record, field.name), _default(field))
    )
    return f"{type(record).__name__}({', '.join(arguments)})"


def _default(field: Field[Any]) -> object:
    return field.default if field.default_factory is MISSING else field.default_factory()


def text_of(record: object) -> str:
    """Return a record as text of at most `MAX_LINES` lines."""
    title, rows = _content(record)
    lines, free = [_cut(title, WIDTH)], MAX_LINES - 1 - len(rows)
    width = max((len(name) for name, _ in rows), default=0)
    for name, text in rows:
        first, *further = _wrapped(text, WIDTH - width - _INDENT, 1 + free) or [""]
        free -= len(further)
        lines.append(_cut(f"  {name:<{width}}  {first}".rstrip(), WIDTH))
        lines += [f"{'':<{width + _INDENT}}{line}" for line in further]
    return "\n".join(lines)


def _wrapped(text: str, width: int, count: int) -> list[str]:
    """Return a text in at most `count` lines; the last one is cut where there is more."""
    joined = _UNIT.sub(_NO_BREAK, text)  # a number and its unit stay on one line
    lines = wrap(joined, width, break_on_hyphens=False) if width > _NARROW else [joined]
    lines = [line.replace(_NO_BREAK, " ") for line in lines]
    if len(lines) <= count:
        return lines
    return [*lines[: count - 1], _cut(" ".join(lines[count - 1 :]), width)]


def _cut(line: str, width: int) -> str:
    return line if len(line) <= width else f"{line[: max(width - 1, 0)]}…"


def html_of(record: object) -> str:
    """Return a record as an HTML table with the same rows."""
    title, rows = _content(record)
    cells = "".join(
        f'<tr><td style="text-align:left">{html.escape(name)}</td>'
        f'<td style="text-align:left">{html.escape(text)}</td></tr>'
        for name, text in rows
    )
    return f"<table><caption>{html.escape(title)}</caption>{cells}</table>"


def _content(record: object) -> tuple[str, list[Row]]:
    if isinstance(record, Headlined):
        title, rows = record.headlines()
    elif isinstance(record, Plottable) and (figures := record.main_figures()) is not None:
        title, rows = figures
    else:
        title, rows = type(record).__name__, list(_field_rows(record))
    rows = [(name, " ".join(text.split())) for name, text in rows]
    maximum = MAX_LINES - 1
    if len(rows) > maximum:
        names = ", ".join(name for name, _ in rows[maximum - 1 :])
        rows = [*rows[: maximum - 1], ("and", f"{len(rows) - maximum + 1} more: {names}")]
    return title, rows


def _field_rows(record: object) -> Iterator[Row]:
    """Yield the fields of a dataclass; the parts of a sequence of records."""
    if isinstance(record, tuple):
        yield from ((str(number), described_value(part)) for number, part in enumerate(record, start=1))
        return
    for field in fields(record):  # type: ignore[arg-type]
        value = getattr(record, field.name)
        if field.repr and value is not None:
            yield field.name, described_value(value)


def described_value(value: object) -> str:
    """Return a value of a record in a few words."""
    for kinds, describe in _DESCRIPTIONS:
        if isinstance(value, kinds):
            return describe(value)
    has_text = is_dataclass(value) and type(value).__str__ is not object.__str__
    return str(value) if has_text else type(value).__name__


def _array(array: np.ndarray[Any, Any]) -> str:
    """Return few numbers as they are, others by shape and range."""
    if array.dtype.kind in "biuf" and array.ndim == 1 and array.size <= LISTED:
        return ", ".join(described_value(value) for value in array.tolist()) or "none"
    shape = " x ".join(map(str, array.shape))
    if array.dtype.kind == "b":
        return f"{shape}, {np.count_nonzero(array)} true"
    if array.dtype.kind not in "iuf" or not np.isfinite(array).any():
        return f"{shape} {array.dtype.name}"
    low, high = (engineering(float(limit(array)), 4) for limit in (np.nanmin, np.nanmax))
    return f"{shape}, {low} to {high}" if low != high else f"{shape}, all {low}"


def _sequence(values: list[object]) -> str:
    plain = all(isinstance(value, str | int | float) for value in values)
    if values and not plain:
        kinds = {type(value).__name__ for value in values}
        return f"{len(values)} {' or '.join(sorted(kinds)[:2])}"
    return _listed([described_value(value) for value in values[:LISTED]], len(values))


def _listed(texts: list[str], count: int) -> str:
    if count <= LISTED:
        return ", ".join(texts) or "none"
    return f"{count}: {', '.join(texts[:LISTED])}, ..."


_DESCRIPTIONS: tuple[tuple[tuple[type, ...], Callable[[Any], str]], ...] = (
    ((np.ndarray,), _array),
    ((Enum,), lambda value: value.name.lower()),
    ((str,), lambda value: next(iter(value.splitlines()), "")),
    ((bool, int, np.bool_, np.integer), str),
    ((float, np.floating), lambda value: engineering(float(value), 6)),
    ((Mapping,), lambda value: _listed([str(name) for name in islice(value, LISTED)], len(value))),
    ((tuple, list, set, frozenset), lambda value: _sequence(list(value))),
)
"""Functions that describe values, by type. The first that fits counts: a member of `Enum` may be an int."""
