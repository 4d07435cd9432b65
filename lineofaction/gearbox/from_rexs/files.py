"""An opened gear unit as files: a case a stage, the scene, its load cases, and the account."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator
from dataclasses import fields
from typing import Any

from lineofaction.gearbox.convert.toml import toml_text
from lineofaction.gearbox.from_rexs.account import Line
from lineofaction.gearbox.from_rexs.load_case import LoadCase
from lineofaction.gearbox.from_rexs.opened import OpenedUnit

SCENE_FILE, LOAD_CASES_FILE, ACCOUNT_FILE = "scene.toml", "load_cases.toml", "import.csv"
_DIGITS = 12


def unit_files(unit: OpenedUnit) -> dict[str, str]:
    """Return the texts of the files by their names."""
    files = {f"{case.name}.toml": toml_text(_plain(case.case)) for case in unit.cases}
    if unit.scene is not None:
        files[SCENE_FILE] = toml_text(_plain(unit.scene))
    if unit.load_cases:
        files[LOAD_CASES_FILE] = toml_text(load_case_tables(unit.load_cases))
    files[ACCOUNT_FILE] = _account_csv(unit.lines)
    return files


def load_case_tables(cases: Iterable[LoadCase]) -> dict[str, Any]:
    """Return the tables of load cases."""
    return {"load_cases": [case.table() for case in cases]}


def _account_csv(lines: Iterable[Line]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = [field.name for field in fields(Line)]
    writer.writerow(names)
    writer.writerows([_safe(getattr(line, name)) for name in names] for line in lines)
    return text.getvalue()


def _safe(value: object) -> object:
    """Return a cell that no spreadsheet takes for a formula: names come from the file."""
    return f"'{value}" if isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t")) else value


def _plain(model: Any) -> dict[str, Any]:
    """Return what a model states, its numbers without the rounding of their computation."""
    return dict(_rounded(model.model_dump(mode="json", exclude_unset=True)))


def _rounded(value: Any) -> Any:
    """Return a value with numbers of twelve digits."""
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_rounded(item) for item in value]
    return float(f"{value:.{_DIGITS}g}") if isinstance(value, float) else value


def report_lines(
    lines: Iterable[Line], fates: tuple[str, ...] = ("refused", "assumed", "defaulted", "derived")
) -> Iterator[str]:
    """Yield the lines of the account that an engineer reads, in order of the fates.

    Components of one type of which the same is said share a line.
    """
    groups: dict[tuple[str, str, str, str], list[Line]] = {}
    for line in lines:
        if line.fate in fates:
            groups.setdefault((line.fate, line.kind, line.item, line.words), []).append(line)
    for fate, kind, item, words in sorted(groups, key=lambda key: fates.index(key[0])):
        group = groups[fate, kind, item, words]
        ids = ", ".join(dict.fromkeys(str(line.component) for line in group))
        name = f' "{group[0].name}"' if len(group) == 1 and group[0].name else ""
        yield f"{fate:9} {kind} {ids}{name}{', ' + item if item else ''}: {words}"
