"""Runs as files: netCDF-4, written at once or block by block, and comma-separated values."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import h5netcdf
import h5py
import numpy as np

from dynamics.errors import ResultError
from dynamics.results.energy_audit import EnergyAudit
from dynamics.results.run_result import RunResult, StepStatistics
from dynamics.results.series import LABELS, SERIES, Series, over_time
from dynamics.types import FloatArray, RunStatus
from model_studies.netcdf import DAMAGE, UnreadableFile, read_dataset

if TYPE_CHECKING:
    import xarray

# The netCDF-4 file of a run, written block by block: memory does not grow with the run.


CHUNK = 8192  # samples that are packed together
PACKING: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
DIRECTIONS = ("x", "y", "z")


class RunFile:
    """Writes beside the final name; `publish` moves the file there whole, leaving without it removes it."""

    def __init__(self, path: Path) -> None:
        self._path = path
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
        os.close(handle)
        self._part = Path(name)
        self._file: Any = h5netcdf.File(self._part, "w")
        self._samples = 0

    def __enter__(self) -> RunFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
        self._part.unlink(missing_ok=True)

    def append(self, fields: Mapping[str, Any]) -> None:
        """Write the next samples of all series; `fields` are those of `RunResult`."""
        if not self._samples:
            self._lay_out(fields)
        first, self._samples = self._samples, self._samples + fields["time"].size
        self._file.resize_dimension("time", self._samples)
        self._file["time"][first : self._samples] = fields["time"]
        for series in SERIES:
            values = fields[series.name]
            if values.size and series.dimensions[-1] == "time":
                self._file[series.name][..., first : self._samples] = values

    def publish(self, attributes: Mapping[str, Any]) -> None:
        """Add the attributes, flush to disk and rename."""
        for name, value in attributes.items():
            self._file.attrs[name] = value
        self._file.close()
        mask = os.umask(0)
        os.umask(mask)
        self._part.chmod(0o666 & ~mask)
        with self._part.open("rb") as written:
            os.fsync(written.fileno())
        self._part.replace(self._path)

    def _lay_out(self, fields: Mapping[str, Any]) -> None:
        labels = {dimension: fields[field] for field, dimension in LABELS.items() if fields[field]}
        labels["direction"] = DIRECTIONS
        self._file.dimensions = {name: len(names) for name, names in labels.items()} | {"time": None}
        for name, names in labels.items():
            variable = self._file.create_variable(name, (name,), h5py.string_dtype())
            variable[...] = np.array(names, dtype=object)
        self._variable(Series("time", ("time",), "s", "time"), fields["time"])
        for series in SERIES:
            if fields[series.name].size:
                self._variable(series, fields[series.name])

    def _variable(self, series: Series, values: FloatArray) -> None:
        """Make one variable; what has no time is written at once."""
        growing = series.dimensions[-1] == "time"
        packing = PACKING | {"chunks": (*values.shape[:-1], CHUNK)} if growing else PACKING
        variable = self._file.create_variable(series.name, series.dimensions, float, **packing)
        variable.attrs.update({"units": series.units, "long_name": series.long_name})
        if not growing:
            variable[...] = values


# Run results as netCDF-4 files.


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


def write_csv(result: RunResult, path: Path) -> None:
    """Write time and every series over time, 9 significant digits, e.g. ``mesh_force[mesh 1] (N)``."""
    names, columns = ["time (s)"], [result.time]
    for series in SERIES:
        if series.dimensions[-1] != "time":
            continue
        values = getattr(result, series.name)
        if not values.size:
            continue
        labels = _labels(result, series.dimensions[:-1])
        for label, column in zip(labels, values.reshape(-1, result.time.size), strict=True):
            names.append(f"{series.name}{label} ({series.units})")
            columns.append(column)
    table: FloatArray = np.stack(columns, axis=1)
    np.savetxt(path, table, fmt="%.9g", delimiter=",", header=",".join(names), comments="")


def _labels(result: RunResult, dimensions: tuple[str, ...]) -> list[str]:
    if not dimensions:
        return [""]
    names = getattr(result, {dimension: field for field, dimension in LABELS.items()}[dimensions[0]])
    if len(dimensions) == 1:
        return [f"[{name}]" for name in names]
    return [f"[{name} {direction}]" for name in names for direction in "xyz"]
