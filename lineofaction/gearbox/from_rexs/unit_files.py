"""An opened gear unit as files: one case per stage, the scene, its load cases, and the account."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from dataclasses import astuple, fields
from typing import Any

from lineofaction.gearbox.from_rexs.account import Line

SCENE_FILE, LOAD_CASES_FILE, ACCOUNT_FILE = "scene.toml", "load_cases.toml", "import.csv"

_FILE_DIGITS = 12


def account_csv(lines: Iterable[Line]) -> str:
    """Return the account of an import as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(field.name for field in fields(Line))
    writer.writerows(map(_safe, astuple(line)) for line in lines)
    return text.getvalue()


def _safe(value: object) -> object:
    """Return a cell that no spreadsheet takes for a formula: names come from the file."""
    return f"'{value}" if isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t")) else value


def plain_table(model: Any) -> dict[str, Any]:
    """Return the fields of a model that are set, its numbers rounded to 12 digits."""
    return dict(_rounded(model.model_dump(mode="json", exclude_unset=True)))


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_rounded(item) for item in value]
    return float(f"{value:.{_FILE_DIGITS}g}") if isinstance(value, float) else value
