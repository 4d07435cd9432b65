"""The result of a run: time series, everything needed to trust them, and its files."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np

from bounds import Quantity, Text
from bounds.brief import Row, brief
from bounds.plottable import Plottable
from dynamics.errors import InputError, ResultError
from dynamics.results.array_file import stored
from dynamics.results.energy_audit import EnergyAudit
from dynamics.results.headlines import headlines
from dynamics.types import FloatArray, Json, RunStatus
from model_studies.array_file import Stored
from model_studies.netcdf import DAMAGE, UnreadableFile, opened_netcdf
from model_studies.netcdf_content import describe, make_dimension

if TYPE_CHECKING:
    import xarray

MESH, FREEDOM = ("mesh", "time"), ("freedom", "time")
BEARING = ("bearing", "direction", "time")
NAMED = ("mesh", "shaft", "bearing", "freedom", "drive", "coupling")
"""Dimensions along which names stand, in the field of the same name."""
CHUNK = 8192  # samples that are packed together
PACKING: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
DIRECTIONS = ("x", "y", "z")
TIME = Stored(("time",), "s", "time")
SCHEMA = "lineofaction dynamics run"
SCHEMA_VERSION = 3  # version of the layout of result files
DOCUMENTS = {"effect_ledger": "{}", "receipt": "{}", "case": "{}", "modes": "{}", "warnings": "[]"}
"""JSON attributes, and the default of those that older files lack."""


@dataclass(frozen=True)
class StepStatistics:
    """Counts and sizes of the steps of a run."""

    accepted: int
    rejected: int
    """`accepted`, `rejected`: Numbers of steps."""
    newton_failures: int
    """Rejected steps in which Newton's method failed."""
    newton_mean: float
    """Newton iterations per implicit stage; 0 for an explicit method."""
    newton_most: int
    """Most Newton iterations in one stage."""
    smallest_step: float
    largest_step: float
    """`smallest_step`, `largest_step`: Sizes of accepted steps, s."""


@brief
@dataclass(frozen=True)
class RunResult(Plottable):
    """Time series on a uniform grid of T samples; m meshes, s shafts, b bearings, n freedoms.

    Fields state unit, meaning and dimensions of arrays.
    """

    time: FloatArray
    """Times of the samples, s. Shape (T,)."""
    mesh: tuple[str, ...]
    shaft: tuple[str, ...]
    bearing: tuple[str, ...]
    freedom: tuple[str, ...]
    drive: tuple[str, ...]
    coupling: tuple[str, ...]
    """`mesh`, `shaft`, `bearing`, `freedom`, `drive`, `coupling`: Names along the axes below."""
    position: FloatArray = field(
        metadata=stored("1", "position by the driving gear in base pitches, in [0, period)", *MESH)
    )
    """Positions by the driving gear; the period is that of the table. Shape (m, T)."""
    mesh_frequency: FloatArray = field(metadata=stored("Hz", "mesh frequency of the mean motion", *MESH))
    """Mesh frequency of the kinematic motion and the own rotation of trains without a drive. Shape (m, T)."""
    dynamic_transmission_error: FloatArray = field(metadata=stored("m", "dynamic transmission error", *MESH))
    """r_b1 theta_1 - r_b2 theta_2 plus the gears' displacements along the line of action; > 0: the driven
    gear lags. Shape (m, T).
    """
    static_transmission_error: FloatArray = field(
        metadata=stored("m", "static transmission error at the nominal force", *MESH)
    )
    """The static reference: the table's at the nominal force and the same position, with misalignment and
    center distance of the static equilibrium at t = 0. Shape (m, T).
    """
    mesh_force: FloatArray = field(metadata=stored("N", "transverse mesh force", *MESH))
    """Force of the driving flank, damping included. It is filtered against aliasing, and the filter may ring
    slightly below 0 at lift-off. Shape (m, T).
    """
    coast_force: FloatArray = field(metadata=stored("N", "transverse force of the coast flank", *MESH))
    """Force of the coast flank; m = 0 here if backlash is off in all meshes. Shape (m, T)."""
    least_mesh_force: FloatArray = field(
        metadata=stored("N", "least mesh force between samples, unfiltered", *MESH)
    )
    largest_mesh_force: FloatArray = field(
        metadata=stored("N", "largest mesh force between samples, unfiltered", *MESH)
    )
    """`least_mesh_force`, `largest_mesh_force`: Least and largest force of the driving flank around each
    sample, >= 0. Shape (m, T) each.
    """
    contact: FloatArray = field(
        metadata=stored("1", "flanks in contact: 0 none, 1 driving, 2 coast, 3 both", *MESH)
    )
    misalignment: FloatArray = field(metadata=stored("m", "misalignment at which the table was read", *MESH))
    center_distance_change: FloatArray = field(metadata=stored("m", "center-distance change likewise", *MESH))
    """`misalignment`, `center_distance_change`: Values by the tilt and displacement of the bodies; m = 0 here
    if the effect is off in all meshes. Shape (m, T) each.
    """
    load_arm: FloatArray = field(
        metadata=stored("m", "arm of the mesh force about mid-face towards +z", *MESH)
    )
    """Arm of the mesh force about the middle of the common face, 0 out of contact; m = 0 here if the moving
    application point is off in all meshes. Shape (m, T).
    """
    speed: FloatArray = field(metadata=stored("rad s-1", "speed about +z", "shaft", "time"))
    """Speed of each shaft. The speed of a flexible shaft is the mean over its inertia, or the speed at the
    section where a rigid drive imposes it. Shape (s, T).
    """
    drive_torque: FloatArray = field(metadata=stored("N m", "drive torque about +z", "drive", "time"))
    """Torque of each drive on its shaft. Shape (d, T)."""
    coupling_torque: FloatArray = field(
        metadata=stored("N m", "torque from the first to the second shaft", "coupling", "time")
    )
    """Torque about +z. Shape (c, T)."""
    bearing_force: FloatArray = field(metadata=stored("N", "force of the shaft on the ground", *BEARING))
    """Force in the fixed frame x, y, z; that of a planet on its pin in the carrier's rotating frame; b = 0 if
    not requested. Shape (b, 3, T).
    """
    bearing_moment: FloatArray = field(metadata=stored("N m", "moment of the shaft on the ground", *BEARING))
    """Moment about each bearing's center in the same frames; the moment about the axis is 0, since the shaft
    turns. b = 0 if not requested or if no bearing has tilt stiffness. Shape (b, 3, T).
    """
    displacement: FloatArray = field(
        metadata=stored("m or rad", "deviation from the kinematic motion", *FREEDOM)
    )
    """`displacement`, `velocity`, `acceleration`: n = 0 if not requested. Shape (n, T) each."""
    velocity: FloatArray = field(metadata=stored("m s-1 or rad s-1", "rate of the deviation", *FREEDOM))
    nominal_force: FloatArray = field(metadata=stored("N", "nominal transverse mesh force", "mesh"))
    status: RunStatus
    statistics: StepStatistics
    energy: EnergyAudit | None
    """Energy audit; None if not requested."""
    effect_ledger: Json = field(default_factory=dict)
    receipt: Json = field(default_factory=dict)
    case: Json = field(default_factory=dict)
    """`effect_ledger`, `receipt`, `case`: Plain JSON: effects on and off with reasons; times and error
    estimate; the scene as resolved, with every damping value used.
    """
    modes: Json = field(default_factory=dict)
    """Natural modes about the static equilibrium at t = 0: lists `frequency` (Hz), `damping_ratio`, `freedom`
    (the one with most of the kinetic energy) and `moves` (the parts with a twentieth of it or more, "shaft,
    how", with their shares); empty if they were not found. Where gyroscopic terms are on also `over_speed`:
    whirl modes (a lists of S values each: `frequency` in Hz, `damping_ratio`, `whirl` from -1, backward, to
    1, forward) at S speeds of `shaft` (`speed`, rad/s; `mesh_frequency` of every mesh, Hz) from rest to the
    largest of the run, closer where modes change their shapes, `freedom` and `moves` at the last.
    """
    warnings: list[Json] = field(default_factory=list)
    """Implausible values of the scene; empty if there are none."""
    acceleration: FloatArray = field(
        default_factory=lambda: np.empty((0, 0)),
        metadata=stored("m s-2 or rad s-2", "second rate of the deviation", *FREEDOM),
    )
    bearing_acceleration: FloatArray = field(
        default_factory=lambda: np.empty((0, 3, 0)),
        metadata=stored("m s-2", "acceleration of the shaft there", *BEARING),
    )
    """Acceleration of the shaft at the bearing, that of a planet relative to its pin, in the frame of
    `bearing_force`; the rotation of a carrier's frame adds no terms. b = 0 if not requested. Shape (b, 3, T).
    """
    elastic_force: FloatArray = field(
        default_factory=lambda: np.empty((0, 0)),
        metadata=stored("N", "elastic part of the mesh force, unfiltered", *MESH),
    )
    """Force of the driving flank by its table at the position and deflection of each sample: the static part
    of the mesh force. m = 0 if not requested. Shape (m, T).
    """

    def headlines(self) -> tuple[str, list[Row]]:
        """Return the lines for a Python prompt: title, and rows of parts, forces and cost."""
        return headlines(self)

    @property
    def sample_rate(self) -> float:
        """Sample rate of the output grid, Hz."""
        return float(self.case["outputs"]["sample_rate"])

    def window(self, start: float, end: float) -> slice:
        """Return the samples with start <= time <= end (s).

        Raises `InputError`: fewer than 2 samples lie there.
        """
        first, last = np.searchsorted(self.time, [start, end * (1.0 + 1e-12)])
        if last - first < 2:
            run = Quantity(float(self.time[-1]), "s")
            bound = Text.of("inside the run, 0 to ", run, ", and longer than a sample")
            raise InputError("window", (start, end), bound)
        return slice(int(first), int(last))

    def to_xarray(self) -> xarray.Dataset:
        """Return the series as a dataset with units, the rest as JSON attributes."""
        from host.optional_modules import xarray  # noqa: PLC0415 (named above for types)

        coordinates: dict[str, Any] = {
            name: (name, np.array(getattr(self, name), dtype=object)) for name in NAMED if getattr(self, name)
        }
        coordinates["time"] = ("time", self.time, {"units": "s", "long_name": "time"})
        coordinates["direction"] = ("direction", np.array(DIRECTIONS, dtype=object))
        data = {}
        for name, series in SERIES.items():
            values = getattr(self, name)
            if values.size:
                about = {"units": series.units, "long_name": series.long_name}
                data[name] = (series.dimensions, values, about)
        return xarray.Dataset(data, coordinates, attributes(vars(self)))

    def to_netcdf(self, path: str | Path) -> None:
        """Write a netCDF-4 file atomically, with lossless compression."""
        fields = dict(vars(self))
        with RunFile(Path(path)) as file:
            for first in range(0, self.time.size, CHUNK):
                part = {name: fields[name][..., first : first + CHUNK] for name in SAMPLED}
                file.append(fields | part)
            file.publish(attributes(fields))

    @classmethod
    def from_netcdf(cls, path: str | Path) -> RunResult:
        """Read a file of `to_netcdf`; equal to the last bit.

        Raises `ResultError`: the file is no run result of this schema.
        """
        path = Path(path)
        try:
            with opened_netcdf(path, decode_vlen_strings=True) as file:
                attributes = dict(file.attrs)
                arrays = {str(name): np.asarray(variable[...]) for name, variable in file.variables.items()}
                sizes = {str(name): dimension.size for name, dimension in file.dimensions.items()}
        except UnreadableFile as error:
            raise ResultError(str(error)) from error
        if attributes.get("schema") != SCHEMA or attributes.get("schema_version") != SCHEMA_VERSION:
            schema = f"{attributes.get('schema')} {attributes.get('schema_version')}"
            raise ResultError(f"{path.name}: schema is {schema}, expected {SCHEMA} {SCHEMA_VERSION}")
        try:
            return _run(attributes, arrays, sizes)
        except DAMAGE as error:
            raise ResultError(f"{path.name}: damaged, its fields are not those of a run") from error

    def to_csv(self, path: str | Path) -> None:
        """Write one row per sample, one column per series, units in the header, 9 significant digits."""
        names, columns = ["time (s)"], [self.time]
        for name, series in OVER_TIME.items():
            values = getattr(self, name)
            if values.size:
                rows = values.reshape(-1, self.time.size)
                labels = _labels(self, series.dimensions[:-1])
                names += [f"{name}{label} ({series.units})" for label, _ in zip(labels, rows, strict=True)]
                columns += list(rows)
        table: FloatArray = np.stack(columns, axis=1)
        np.savetxt(path, table, fmt="%.9g", delimiter=",", header=",".join(names), comments="")


_STORED: dict[str, Stored] = {
    entry.name: entry.metadata["stored"] for entry in fields(RunResult) if "stored" in entry.metadata
}
OVER_TIME = {name: entry for name, entry in _STORED.items() if entry.dimensions[-1] == "time"}
"""Series over time."""
SAMPLED = ("time", *OVER_TIME)
"""Fields with one value per sample."""
SERIES = OVER_TIME | _STORED
"""All series of a result, in the order of its files."""


class RunFile:
    """The file of a run, written next to its final name; `publish` moves it there whole, else it vanishes."""

    def __init__(self, path: Path) -> None:
        import h5py  # noqa: PLC0415 - needed for files only

        self._path = path
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
        os.close(handle)
        self._part = Path(name)

        self._file: Any = h5py.File(self._part, "w", track_order=True)
        self._growing: dict[str, Any] = {}
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
        for name, variable in self._growing.items():
            variable.resize(self._samples, axis=variable.ndim - 1)
            variable[..., first:] = fields[name]

    def publish(self, attributes: Mapping[str, Any]) -> None:
        """Add the attributes, flush to disk and rename."""
        describe(self._file, attributes)
        self._file.close()
        mask = os.umask(0)
        os.umask(mask)
        self._part.chmod(0o666 & ~mask)
        with self._part.open("rb") as written:
            os.fsync(written.fileno())
        self._part.replace(self._path)

    def _lay_out(self, fields: Mapping[str, Any]) -> None:
        """Make all variables; those along dimensions, which others refer to, come first."""
        import h5py  # noqa: PLC0415

        names = {name: fields[name] for name in NAMED if fields[name]} | {"direction": DIRECTIONS}
        for number, (name, texts) in enumerate(names.items()):
            labels = np.array(texts, dtype=h5py.string_dtype())
            make_dimension(self._file.create_dataset(name, data=labels, track_order=True), number, name)
        make_dimension(self._variable("time", TIME, fields["time"]), len(names), "time")
        for name, series in SERIES.items():
            if fields[name].size:
                variable = self._variable(name, series, fields[name])
                for axis, dimension in enumerate(series.dimensions):
                    variable.dims[axis].attach_scale(self._file[dimension])

    def _variable(self, name: str, series: Stored, values: FloatArray) -> Any:
        """Make one variable; one without time is written at once."""
        if series.dimensions[-1] == "time":
            parts = values.shape[:-1]
            shapes = {"shape": (*parts, 0), "maxshape": (*parts, None), "chunks": (*parts, CHUNK)}
            options: dict[str, Any] = {**shapes, "dtype": float}
        else:
            options = {"data": values}
        variable = self._file.create_dataset(name, **options, **PACKING, track_order=True)
        describe(variable, {"units": series.units, "long_name": series.long_name})
        if series.dimensions[-1] == "time":
            self._growing[name] = variable
        return variable


def attributes(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Return all that is not a series, of the fields of a `RunResult`."""
    status, energy = fields["status"], fields["energy"]
    return {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "status": status.name,
        "statistics": json.dumps(asdict(fields["statistics"])),
        "energy": json.dumps(energy.to_json() if energy else None),
        **{name: json.dumps(fields[name]) for name in DOCUMENTS},
    }


def _run(attributes: Mapping[str, Any], arrays: Mapping[str, Any], sizes: Mapping[str, int]) -> RunResult:
    """Return the run of a file by its attributes, its variables and the sizes of its dimensions."""
    fields: dict[str, Any] = {
        name: tuple(str(item) for item in arrays[name]) if name in arrays else () for name in NAMED
    }
    sizes = {"direction": len(DIRECTIONS), **sizes}
    for name, series in SERIES.items():
        if name in arrays:
            fields[name] = np.asarray(arrays[name], dtype=float)
        else:
            fields[name] = np.empty([0, *(sizes.get(dimension, 0) for dimension in series.dimensions[1:])])
    energy = json.loads(attributes["energy"])
    return RunResult(
        time=np.asarray(arrays["time"], dtype=float),
        **fields,
        status=RunStatus[attributes["status"]],
        statistics=StepStatistics(**json.loads(attributes["statistics"])),
        energy=EnergyAudit.from_json(energy) if energy else None,
        **{name: json.loads(attributes.get(name, absent)) for name, absent in DOCUMENTS.items()},
    )


def _labels(result: RunResult, dimensions: tuple[str, ...]) -> list[str]:
    names = getattr(result, dimensions[0])
    if len(dimensions) == 1:
        return [f"[{name}]" for name in names]
    return [f"[{name} {direction}]" for name in names for direction in "xyz"]
