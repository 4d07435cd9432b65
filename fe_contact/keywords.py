"""The keywords of `analyze`: each sets the field of that name of its axes, options or run.

A type checker cannot take the fields of a dataclass as keywords of a call, so they are repeated here with
their types; `tests/contract/test_keywords_of_analyze.py` compares both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, TypedDict

from fe_contact.allowed_error import AllowedError
from fe_contact.options import AnalysisOptions, Levels, OnPlan, Run, TableAxes
from model_studies import Progress
from model_studies.workers import Workers


class TableKeywords(TypedDict, total=False):
    """Fields of `TableAxes`, `AnalysisOptions` and `Run`.

    A `tolerance` that is a number is its relative part: 0.01 is 1 % or 20 nm, the larger of both.
    """

    torques: Levels | None
    normal_forces: Levels | None
    misalignments: Levels
    center_distance_changes: Levels
    pitches: int | None
    tolerance: AllowedError | float | None
    time_budget: float | None
    level: str | None
    model: str
    positions: int | None
    effects: Mapping[str, str]
    receipt: str
    on_violation: str
    workers: Workers
    cache: Path | None
    progress: Progress
    on_plan: OnPlan


def with_keywords(
    axes: TableAxes | None, options: AnalysisOptions, run: Run, keywords: TableKeywords
) -> tuple[TableAxes | None, AnalysisOptions, Run]:
    """Return axes, options and run with the keywords in place of their fields.

    Raises `InputError`: a value cannot be used; it names the field. Raises `TypeError`: an unknown keyword.
    """
    known = TableKeywords.__annotations__
    unknown = keywords.keys() - known
    if unknown:
        raise TypeError(f"analyze() has no keyword {min(unknown)!r}; it has {', '.join(known)}")
    changes = _fields_of(AnalysisOptions, keywords)
    if "tolerance" in changes:
        changes["tolerance"] = AllowedError.from_value(changes["tolerance"])
    levels = _fields_of(TableAxes, keywords)
    if levels:
        axes = TableAxes(**levels) if axes is None else replace(axes, **levels)
    return axes, replace(options, **changes), replace(run, **_fields_of(Run, keywords))


def _fields_of(record: type, keywords: Mapping[str, Any]) -> dict[str, Any]:
    return {field.name: keywords[field.name] for field in fields(record) if field.name in keywords}
