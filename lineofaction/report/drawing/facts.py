"""Plain JSON metadata as tables: the case, the receipt, the effect ledger, the software versions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from lineofaction.report.drawing.figure import Table

# endings of field names that state a unit, longest first
_UNITS = {
    "_n_m": "N m", "_n_per_m": "N/m", "_n_s_per_m": "N s/m", "_kg_m2": "kg m²",
    "_um": "µm", "_mm": "mm", "_deg": "°", "_rpm": "rpm", "_gpa": "GPa", "_hz": "Hz", "_kg": "kg",
    "_mib": "MiB", "_mb": "MB", "_n": "N", "_m": "m", "_s": "s",
}  # fmt: skip


def facts(caption: str, content: Mapping[str, Any]) -> Table:
    """Flatten nested settings into a table of two columns; a list of numbers stays in one cell."""
    return Table(caption, ("quantity", "value"), tuple(_rows(content)))


def records(caption: str, content: Sequence[Mapping[str, Any]]) -> Table:
    """Tabulate a list of records that share their fields; the fields of the first record make the columns."""
    fields = tuple(dict.fromkeys(name for record in content for name in record))
    rows = tuple(tuple(_cell(record.get(name)) for name in fields) for record in content)
    return Table(caption, tuple(_words(name) for name in fields), rows)


def side_by_side(caption: str, columns: Mapping[str, Mapping[str, Any]]) -> Table:
    """Tabulate settings of the same names beside each other, for example of both gears."""
    contents = {name: dict(_rows(content)) for name, content in columns.items()}
    labels = dict.fromkeys(label for content in contents.values() for label in content)
    rows = tuple((label, *(content.get(label, "") for content in contents.values())) for label in labels)
    return Table(caption, ("quantity", *contents), rows)


def _rows(content: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, str]]:
    """Walk nested mappings, naming each leaf by its path."""
    for name, value in content.items():
        label = f"{before}{_words(name)}"
        if isinstance(value, Mapping):
            yield from _rows(value, f"{label} · ")
        elif _is_record_list(value):
            for index, record in enumerate(value):
                yield from _rows(record, f"{label} {index + 1} · ")
        elif value is not None:
            yield label, _cell(value)


def _is_record_list(value: object) -> bool:
    return isinstance(value, list | tuple) and bool(value) and all(isinstance(v, Mapping) for v in value)


def _words(name: str) -> str:
    """Turn a field name into words, its unit after a comma."""
    for ending, unit in _UNITS.items():
        if name.endswith(ending) and len(name) > len(ending):
            return f"{name.removesuffix(ending).replace('_', ' ')}, {unit}"
    return name.replace("_", " ")


def _cell(value: object) -> str:
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        return ", ".join(f"{_words(str(k))} {_cell(v)}" for k, v in value.items())
    if isinstance(value, Sequence) and not isinstance(value, str):
        return ", ".join(_cell(v) for v in value)
    return str(value)
