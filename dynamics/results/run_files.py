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
from dynamics.results.run_result import NAMED, OVER_TIME, SAMPLED, SERIES, RunResult, StepStatistics
from dynamics.types import FloatArray, RunStatus
from model_studies.array_file import Stored
from model_studies.netcdf import DAMAGE, UnreadableFile, read_dataset

if TYPE_CHECKING:
    import xarray

# The netCDF-4 file of a run, written block by block: memory does not grow with the run.


CHUNK = 8192  # samples that are packed together
PACKING: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
DIRECTIONS = ("x", "y", "z")
TIME = Stored(("time",), "s", "time")


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
        for name in OVER_TIME:
            if fields[name].size:
                self._file[name][..., first : self._samples] = fields[name]

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
        labels = {name: fields[name] for name in NAMED if fields[name]}
        labels["direction"] = DIRECTIONS
        self._file.dimensions = {name: len(names) for name, names in labels.items()} | {"time": None}
        for name, names in labels.items():
            variable = self._file.create_variable(name, (name,), h5py.string_dtype())
            variable[...] = np.array(names, dtype=object)
        for name, series in ({"time": TIME} | SERIES).items():
            if fields[name].size:
                self._variable(name, series, fields[name])

    def _variable(self, name: str, series: Stored, values: FloatArray) -> None:
        """Make one variable; what has no time is written at once."""
        growing = series.dimensions[-1] == "time"
        packing = PACKING | {"chunks": (*values.shape[:-1], CHUNK)} if growing else PACKING
        variable = self._file.create_variable(name, series.dimensions, float, **packing)
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
        name: (name, np.array(getattr(result, name), dtype=object)) for name in NAMED if getattr(result, name)
    }
    coordinates["time"] = ("time", result.time, {"units": "s", "long_name": "time"})
    coordinates["direction"] = ("direction", np.array(DIRECTIONS, dtype=object))
    data = {
        name: (series.dimensions, values, {"units": series.units, "long_name": series.long_name})
        for name, series in SERIES.items()
        if (values := getattr(result, name)).size
    }
    return xarray.Dataset(data, coordinates, attributes(vars(result)))


def write_netcdf(result: RunResult, path: Path) -> None:
    """Write to a neighbor of `path`, then move it there in one step."""
    fields = dict(vars(result))
    with RunFile(path) as file:
        for first in range(0, result.time.size, CHUNK):
            part = {name: fields[name][..., first : first + CHUNK] for name in SAMPLED}
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
        name: tuple(str(each) for each in dataset[name].values) if name in dataset.coords else ()
        for name in NAMED
    }
    sizes = {"direction": len(DIRECTIONS), **{str(key): size for key, size in dataset.sizes.items()}}
    fields |= {
        name: np.asarray(dataset[name].values, dtype=float)
        if name in dataset
        else np.empty([0, *(sizes.get(dimension, 0) for dimension in series.dimensions[1:])])
        for name, series in SERIES.items()
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
    for name, series in OVER_TIME.items():
        values = getattr(result, name)
        if values.size:
            rows = values.reshape(-1, result.time.size)
            labels = _labels(result, series.dimensions[:-1])
            names += [f"{name}{label} ({series.units})" for label, _ in zip(labels, rows, strict=True)]
            columns += list(rows)
    table: FloatArray = np.stack(columns, axis=1)
    np.savetxt(path, table, fmt="%.9g", delimiter=",", header=",".join(names), comments="")


def _labels(result: RunResult, dimensions: tuple[str, ...]) -> list[str]:
    names = getattr(result, dimensions[0])
    if len(dimensions) == 1:
        return [f"[{name}]" for name in names]
    return [f"[{name} {direction}]" for name in names for direction in "xyz"]
