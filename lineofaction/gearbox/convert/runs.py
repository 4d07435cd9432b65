"""The attributes of a run's file."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from lineofaction.gearbox.convert.stamp import WARNINGS, stamped
from lineofaction.gearbox.registry import study_of
from model_studies.netcdf import opened_netcdf

# The figures of a stored file, as JSON, by the kind of the result.


def staged(report: Callable[[str, float], None]) -> Callable[[float, str], None]:
    """Return the progress callback of `dynamics.simulation` that feeds ``report(stage, fraction)``."""
    return lambda fraction, _doing: report("integration", fraction)


def run_json(file: Path) -> dict[str, Any]:
    """Return attributes, dimensions and variables (with units) of a run, without its data."""
    with opened_netcdf(file) as run:
        return {
            "attributes": {name: _plain(value) for name, value in run.attrs.items()},
            "dimensions": {name: int(each.size) for name, each in run.dimensions.items()},
            "variables": {
                name: {"dimensions": list(variable.dimensions), "units": variable.attrs.get("units", "")}
                for name, variable in run.variables.items()
            },
        }


def _plain(value: object) -> object:
    """Attribute as JSON; a number that JSON cannot hold is shown as text, and JSON in a text is unfolded."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, float) and not np.isfinite(value):
        return str(value)
    if isinstance(value, list):
        return [_plain(item) for item in value]
    if isinstance(value, str) and value[:1] in "[{":
        try:
            return json.loads(value)
        except json.JSONDecodeError:
            return value
    return value


def figures_of(kind: str, file: Path) -> dict[str, Any]:
    """Return what a stored file of a run or a study says, its warnings included."""
    study = study_of(kind)
    figures = run_json(file) if study is None else study.run.facts(study.run.file.read(file))
    return figures | {WARNINGS: stamped(file)}
