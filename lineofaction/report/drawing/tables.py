"""Tables of settings and records, of effects, and of the cost of housings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from bounds import engineering, leftover
from bounds.unit import MIN_LEFTOVER
from lineofaction.gearbox.convert.effects import trifles_title
from lineofaction.gearbox.convert.scene_effects import SceneEffect, scene_effects
from lineofaction.gearbox.units import UNITS, ending_of
from lineofaction.report.drawing.figure import Table, number
from lineofaction.report.drawing.page import Part, Section

_SYMBOLS = str.maketrans({"^": "", "2": "²", "3": "³"})
"""Powers of units as they are printed."""
LARGE = 10**7
"""Integer from which on only `_DIGITS` of its digits are written: bytes and operations."""
_DIGITS = 4
_DEGREE = {"deg": "°", "degC": "°C"}
EffectRow = tuple[str, str, bool, str, str]
"""An effect: its name, its part, whether it is simulated, its influence in words, and the reason."""
Json = dict[str, Any]
GIGABYTE = 1e9
"""Bytes of a GB."""
HEAD = ("work", "CPU s", "CPU s predicted", "GB", "GB predicted")
UNKNOWN = "-"
"""Cell of a cost that nobody measured or predicted."""
MIN = 1e-3
"""Least cost that is written as a number, CPU seconds or GB."""


def settings_table(caption: str, content: Mapping[str, Any]) -> Table:
    """Flatten nested settings into a table of two columns; a list of numbers stays in one cell."""
    return Table(caption, ("quantity", "value"), tuple(_rows(content)))


def records(caption: str, content: Sequence[Mapping[str, Any]]) -> Table:
    """Tabulate a list of records; a field of any record is a column, in the order of first appearance."""
    fields = tuple(dict.fromkeys(name for record in content for name in record))
    rows = tuple(tuple(_cell(record.get(name)) for name in fields) for record in content)
    return Table(caption, tuple(_column_title(name) for name in fields), rows)


def side_by_side(caption: str, columns: Mapping[str, Mapping[str, Any]]) -> Table:
    """Tabulate settings of the same names side by side, for example of both gears."""
    contents = {name: dict(_rows(content)) for name, content in columns.items()}
    labels = dict.fromkeys(label for content in contents.values() for label in content)
    rows = tuple((label, *(content.get(label, "") for content in contents.values())) for label in labels)
    return Table(caption, ("quantity", *contents), rows)


def _rows(content: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, str]]:
    for name, value in content.items():
        label = f"{before}{_column_title(name)}"
        if isinstance(value, Mapping):
            yield from _rows(value, f"{label} · ")
        elif isinstance(value, list | tuple) and bool(value) and all(isinstance(v, Mapping) for v in value):
            for index, record in enumerate(value):
                yield from _rows(record, f"{label} {index + 1} · ")
        elif value is not None:
            yield label, _cell(value)


def _column_title(name: str) -> str:
    """Turn a field name into words, its unit after a comma."""
    ending = ending_of(name)
    bare = name.removesuffix(ending)
    if not ending or not bare:
        return name.replace("_", " ")
    unit = UNITS[ending].name
    return f"{bare.replace('_', ' ')}, {_DEGREE.get(unit, unit.translate(_SYMBOLS))}"


def _cell(value: object) -> str:
    if value is None or isinstance(value, bool):
        return {None: "none", True: "yes", False: "no"}[value]
    if isinstance(value, float):
        return leftover(value) if 0.0 < abs(value) < MIN_LEFTOVER else f"{value + 0.0:.6g}"
    if isinstance(value, int) and abs(value) >= LARGE:
        return engineering(float(value), _DIGITS)
    if isinstance(value, Mapping):
        return ", ".join(f"{_column_title(str(k))} {_cell(v)}" for k, v in value.items())
    if isinstance(value, Sequence) and not isinstance(value, str):
        return ", ".join(_cell(v) for v in value)
    return str(value)


def effect_table(caption: str, rows: Iterable[EffectRow]) -> Table:
    """Tabulate effects, by their names in words."""
    cells = []
    for name, part, on, influence, reason in rows:
        cells.append((name.replace("_", " "), part, "yes" if on else "no", influence, reason))
    return Table(caption, ("effect", "in", "simulated", "without it", "because"), tuple(cells))


def effects_section(text: str, rows: Iterable[EffectRow], tables: tuple[Table, ...]) -> Section:
    """Show effects under a sentence on their influences."""
    return Section("Effects", text, tables=(effect_table("Effects", rows),), folded=tables, part=Part.EFFECTS)


def one_effects_section(sections: Sequence[Section]) -> tuple[Section, ...]:
    """Return sections with all effect sections as one: rows in one table, in the order of the sections.

    A decision that several sections state has one row, that of the last section that estimates its size by a
    run or a study, not as a displacement at rest: results over other ranges give other sizes.
    """
    effects = [section for section in sections if section.part is Part.EFFECTS]
    others = tuple(section for section in sections if section.part is not Part.EFFECTS)
    if len(effects) < 2:
        return tuple(sections)
    rows: dict[tuple[str, ...], tuple[str, ...]] = {}
    tables = [table for section in effects for table in section.tables]
    for row in (row for table in tables for row in table.rows):
        *decision, size, _ = row
        if tuple(decision) not in rows or not (size == "nothing" or size.endswith("at rest")):
            rows[tuple(decision)] = row
    text = " ".join(section.text for section in effects if section.text)
    table = replace(effects[0].tables[0], rows=tuple(rows.values()))
    folded = tuple(dict.fromkeys(table for section in effects for table in section.folded))
    return (*others, replace(effects[0], text=text, tables=(table,), folded=folded))


def ledger_section(ledger: Mapping[str, Any]) -> Section:
    """Tabulate the simulated and the neglected effects by the effect ledger of a scene."""
    main, trifles = scene_effects(ledger)
    folded = []
    if trifles:
        title = trifles_title({effect.name for effect in trifles})
        folded.append(effect_table(title, map(_effect_row, trifles)))
    phases = tuple((row["part"], row["words"]) for row in ledger.get("assumed", ()))
    if phases:
        folded.append(Table("Assumed of phases", ("part", "assumed"), phases))
    folded.append(settings_table("Not in the model", ledger.get("left_out", {})))
    return effects_section("", map(_effect_row, main), tuple(folded))


def _effect_row(effect: SceneEffect) -> EffectRow:
    return effect.name, effect.parts, effect.on, effect.size, effect.reason


def cost_tables(metadata: Mapping[str, Any]) -> tuple[Table, ...]:
    """Return the table of predicted and measured cost of the housings; nothing where no cost is known."""
    rows = []
    for name, cost in _work(metadata):
        seconds = amount(cost["seconds"]), amount(cost["predicted_seconds"])
        rows.append((name, *seconds, gigabytes(cost["bytes"]), gigabytes(cost["predicted_bytes"])))
    return (Table("Cost of the housings, once: results are kept", HEAD, tuple(rows)),) if rows else ()


def _work(metadata: Mapping[str, Any]) -> Iterator[tuple[str, Json]]:
    for housing, cost in metadata.get("reduction_cost", {}).items():
        yield f"{housing}: reduction", cost
    for housing, radiation in metadata.get("radiation", {}).items():
        if "cost" in radiation:
            model = radiation["model_name"].replace("_", " ")
            yield f"{housing}: {model}, all frequencies", radiation["cost"]


def amount(value: float | None) -> str:
    """Write CPU seconds or GB; a cost below `MIN` is written as less than that."""
    if value is None:
        return UNKNOWN
    return number(value, 2) if value >= MIN else f"< {MIN:g}"


def gigabytes(value: float | None) -> str:
    """Write bytes in GB."""
    return amount(None if value is None else value / GIGABYTE)
