"""The netCDF-4 file of a run, written block by block: memory does not grow with the run."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Any

import h5netcdf
import h5py
import numpy as np

from dynamics.results.series import LABELS, SERIES, Series
from dynamics.types import FloatArray

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
        """Make dimensions, names and variables from the first samples."""
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
