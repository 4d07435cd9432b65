"""The figures of a stored file, as JSON, by the kind of the result."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from bounds.types import Json
from lineofaction.gearbox.registry import study_of
from lineofaction.gearbox.result_files import LEDGER, WARNINGS, stamped
from lineofaction.gearbox.units import boundary_ledger
from model_studies.netcdf import opened_netcdf


def figures_of(kind: str, file: Path) -> dict[str, Any]:
    """Return the figures of a stored file of a run or a study, with its warnings."""
    study = study_of(kind)
    figures = run_json(file) if study is None else study.run.figures(study.run.file.read(file))
    return figures | {WARNINGS: stamped(file)}


def making_of(file: Path) -> Json:
    """Return the origin of a result by its netCDF file: case or scene, receipt, effects, versions."""
    with opened_netcdf(file) as content:
        return {name: _plain(value) for name, value in content.attrs.items()}


def run_json(file: Path) -> dict[str, Any]:
    """Return attributes, dimensions and variables (with units) of a run, without its data."""
    with opened_netcdf(file) as run:
        attributes = {name: _plain(value) for name, value in run.attrs.items()}
        if LEDGER in attributes:
            attributes[LEDGER] = boundary_ledger(attributes[LEDGER])
        return {
            "attributes": attributes,
            "dimensions": {name: int(dimension.size) for name, dimension in run.dimensions.items()},
            "variables": {
                name: {"dimensions": list(variable.dimensions), "units": variable.attrs.get("units", "")}
                for name, variable in run.variables.items()
            },
        }


def _plain(value: object) -> object:
    """Return an attribute as JSON; infinite numbers and NaN as text, JSON in a text as its value."""
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
