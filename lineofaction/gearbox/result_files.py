"""What the files of results say of themselves: warnings, attributes, the case they were made of."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5netcdf
import numpy as np

from bounds.types import Json
from lineofaction.gearbox.registry import study_of
from lineofaction.gearbox.studies.bodies import UNIT
from lineofaction.gearbox.units import boundary_ledger
from model_studies.netcdf import opened, opened_netcdf

LEDGER, WARNINGS, COMPLAINT = "effect_ledger", "warnings", "complaint"


def stamp(file: Path, warnings: Sequence[Json]) -> None:
    """Write warnings into a file that this program has just made; other kinds of files stay as they are."""
    if file.suffix == ".nc":
        with h5netcdf.File(file, "r+") as content:
            content.attrs[WARNINGS] = json.dumps(list(warnings))
    elif file.suffix == ".json":
        text = json.dumps(json.loads(file.read_text(encoding="utf-8")) | {WARNINGS: list(warnings)})
        file.write_text(f"{text}\n", encoding="utf-8")


def stamp_scene(file: Path, facts: Json) -> None:
    """Write what the facts of a scene say of its complaint and its unit into the file of a result."""
    with h5netcdf.File(file, "r+") as content:
        for name in (COMPLAINT, UNIT):
            if name in facts:
                content.attrs[name] = json.dumps(facts[name])


def stamped(file: Path) -> list[Json]:
    """Return the warnings of the netCDF file of a result; none of an older one."""
    with opened_netcdf(file) as content:
        return list(json.loads(content.attrs.get(WARNINGS, "[]")))


def making_of(file: Path) -> Json:
    """Return what a result's netCDF file says of its making: case or scene, receipt, effects, versions."""
    with opened_netcdf(file) as content:
        return {name: _plain(value) for name, value in content.attrs.items()}


# The figures of a stored file, as JSON, by the kind of the result.


def run_json(file: Path) -> dict[str, Any]:
    """Return attributes, dimensions and variables (with units) of a run, without its data."""
    with opened_netcdf(file) as run:
        attributes = {name: _plain(value) for name, value in run.attrs.items()}
        if LEDGER in attributes:
            attributes[LEDGER] = boundary_ledger(attributes[LEDGER])
        return {
            "attributes": attributes,
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
    figures = run_json(file) if study is None else study.run.figures(study.run.file.read(file))
    return figures | {WARNINGS: stamped(file)}


# The case that a database file was made of, without reading its arrays.


def case_of_file(file: Path) -> dict[str, Any] | None:
    """Return the case with all defaults, None if the file is none that can be read."""
    try:
        with opened(file) as content:
            case = json.loads(content.attrs["case"])
    except (KeyError, TypeError, ValueError):
        return None
    return case if isinstance(case, dict) else None
