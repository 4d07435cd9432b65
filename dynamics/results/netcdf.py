"""Run results as netCDF-4 files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dynamics.errors import ResultError
from dynamics.results.energy_audit import EnergyAudit
from dynamics.results.run_file import CHUNK, DIRECTIONS, RunFile
from dynamics.results.run_result import RunResult
from dynamics.results.series import LABELS, SERIES, over_time
from dynamics.results.step_statistics import StepStatistics
from dynamics.types import RunStatus
from model_studies.netcdf_input import DAMAGE, UnreadableFile, read_dataset

if TYPE_CHECKING:
    import xarray

SCHEMA = "lineofaction dynamics run"
SCHEMA_VERSION = 3
DOCUMENTS = {"effect_ledger": "{}", "receipt": "{}", "case": "{}", "modes": "{}", "warnings": "[]"}
"""JSON attributes, and the default of those that older files lack."""


def to_dataset(result: RunResult) -> xarray.Dataset:
    """Return `result` as a dataset: CF-style names and units, documents as JSON attributes."""
    import xarray  # noqa: PLC0415 - a second, and not needed to run a scene

    coordinates: dict[str, Any] = {
        dimension: (dimension, np.array(getattr(result, field), dtype=object))
        for field, dimension in LABELS.items()
        if getattr(result, field)
    }
    coordinates["time"] = ("time", result.time, {"units": "s", "long_name": "time"})
    coordinates["direction"] = ("direction", np.array(DIRECTIONS, dtype=object))
    data = {
        series.name: (
            series.dimensions,
            getattr(result, series.name),
            {"units": series.units, "long_name": series.long_name},
        )
        for series in SERIES
        if getattr(result, series.name).size
    }
    return xarray.Dataset(data, coordinates, attributes(vars(result)))


def write_netcdf(result: RunResult, path: Path) -> None:
    """Write to a neighbor of `path`, then move it there in one step."""
    fields = dict(vars(result))
    with RunFile(path) as file:
        for first in range(0, result.time.size, CHUNK):
            part = {name: fields[name][..., first : first + CHUNK] for name in over_time()}
            file.append(fields | part)
        file.publish(attributes(fields))


def read_netcdf(path: Path) -> RunResult:
    """Read a file of `write_netcdf`."""
    try:
        dataset = read_dataset(path, decode_times=False)
    except UnreadableFile as error:
        raise ResultError(str(error)) from error
    if dataset.attrs.get("schema") != SCHEMA or dataset.attrs.get("schema_version") != SCHEMA_VERSION:
        stated = f"{dataset.attrs.get('schema')} {dataset.attrs.get('schema_version')}"
        raise ResultError(f"{path.name}: schema is {stated}, expected {SCHEMA} {SCHEMA_VERSION}")
    try:
        return _from_dataset(dataset)
    except DAMAGE as error:
        raise ResultError(f"{path.name}: damaged, its fields are not those of a run") from error


def attributes(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Return all that is not a series, of the fields of a `RunResult`."""
    status, energy = fields["status"], fields["energy"]
    return {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "status": status.name,
        "statistics": json.dumps(fields["statistics"].to_json()),
        "energy": json.dumps(energy.to_json() if energy else None),
        **{name: json.dumps(fields[name]) for name in DOCUMENTS},
    }


def _from_dataset(dataset: xarray.Dataset) -> RunResult:
    fields: dict[str, Any] = {
        field: tuple(str(name) for name in dataset[dimension].values) if dimension in dataset.coords else ()
        for field, dimension in LABELS.items()
    }
    sizes = {"direction": len(DIRECTIONS), **{str(key): size for key, size in dataset.sizes.items()}}
    fields |= {
        entry.name: np.asarray(dataset[entry.name].values, dtype=float)
        if entry.name in dataset
        else np.empty([0, *(sizes.get(dimension, 0) for dimension in entry.dimensions[1:])])
        for entry in SERIES
    }
    energy = json.loads(dataset.attrs["energy"])
    return RunResult(
        time=np.asarray(dataset["time"].values, dtype=float),
        **fields,
        status=RunStatus[dataset.attrs["status"]],
        statistics=StepStatistics(**json.loads(dataset.attrs["statistics"])),
        energy=EnergyAudit.from_json(energy) if energy else None,
        **{name: json.loads(dataset.attrs.get(name, absent)) for name, absent in DOCUMENTS.items()},
    )
