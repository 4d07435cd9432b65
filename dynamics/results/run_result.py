"""The result of a run: time series and everything needed to trust them."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bounds import Quantity, Text
from dynamics.errors import InputError
from dynamics.results.array_file import stored
from dynamics.results.energy_audit import EnergyAudit
from dynamics.types import FloatArray, Json, RunStatus
from model_studies.array_file import Stored

if TYPE_CHECKING:
    import xarray

# The work of the integrator.


@dataclass(frozen=True)
class StepStatistics:
    """Counts and sizes of the steps of a run.

    Attributes
    ----------
    accepted, rejected : int
        Steps.
    newton_failures : int
        Rejected steps in which Newton's method failed.
    newton_mean : float
        Newton iterations per implicit stage; 0 for an explicit method.
    newton_most : int
        In one stage.
    smallest_step, largest_step : float
        Accepted, s.
    """

    accepted: int
    rejected: int
    newton_failures: int
    newton_mean: float
    newton_most: int
    smallest_step: float
    largest_step: float

    def to_json(self) -> Json:
        """Return plain numbers."""
        return asdict(self)


MESH, FREEDOM = ("mesh", "time"), ("freedom", "time")
BEARING = ("bearing", "direction", "time")


@dataclass(frozen=True)
class RunResult:
    """Time series on a uniform grid of T samples; m meshes, s shafts, b bearings, n freedoms.

    Fields state unit, meaning and dimensions of arrays.

    Attributes
    ----------
    time : (T,) array
        s.
    mesh, shaft, bearing, freedom, drive, coupling : tuples of str
        Names along the axes below.
    position : (m, T) array
        The period is that of the table.
    mesh_frequency : (m, T) array
        Of the kinematic motion and the own rotation of trains without a drive.
    dynamic_transmission_error : (m, T) array
        r_b1 theta_1 - r_b2 theta_2 plus the gears' displacements along the line of action; > 0: the
        driven gear lags.
    static_transmission_error : (m, T) array
        The static reference: the table's at the nominal force and the same position, with misalignment and
        center distance of the static equilibrium at t = 0.
    mesh_force : (m, T) array
        Of the driving flank, damping included; filtered against aliasing, which may ring slightly below 0 at
        lift-off.
    coast_force : (m, T) array
        m = 0 here if backlash is off in all meshes.
    least_mesh_force, largest_mesh_force : (m, T) arrays
        Of the driving flank around each sample, >= 0.
    misalignment, center_distance_change : (m, T) arrays
        As bodies tilt and move; m = 0 here if the effect is off in all meshes.
    load_centroid : (m, T) array
        From the middle of the common face, 0 out of contact; m = 0 here if the moving application point is
        off in all meshes.
    speed : (s, T) array
        Of a flexible shaft the mean over its inertia, or where a rigid drive imposes it.
    drive_torque : (d, T) array
        On each drive's shaft.
    coupling_torque : (c, T) array
        About +z.
    bearing_force : (b, 3, T) array
        In the fixed frame x, y, z; of a planet on its pin in the carrier's rotating frame; b = 0 if not
        requested.
    bearing_moment : (b, 3, T) array
        About each bearing's center in the same frames; the one about the axis is 0, since the shaft turns.
        b = 0 if not requested or if no bearing has tilt stiffness.
    displacement, velocity, acceleration : (n, T) arrays
        n = 0 if not requested.
    status : RunStatus
    statistics : StepStatistics
    energy : EnergyAudit or None
        None if not requested.
    effect_ledger, receipt, case : dict
        Plain JSON: effects on and off with reasons; times and error estimate; the scene as resolved, with
        every damping value used.
    modes : dict
        Natural modes about the static equilibrium at t = 0: lists `frequency` (Hz), `damping_ratio`,
        `freedom` (the one with most of the kinetic energy) and `moves` (the parts with a twentieth of it or
        more, "shaft, how", with their shares); empty if they were not found. Where gyroscopic
        terms are on also `over_speed`: whirl modes (a lists of S values each: `frequency` in Hz,
        `damping_ratio`, `whirl` from -1, backward, to 1, forward) at S speeds of `shaft` (`speed`, rad/s;
        `mesh_frequency` of every mesh, Hz) from rest to the largest of the run, `freedom` and `moves` at
        the last.
    warnings : list of dict
        Implausible values of the scene; empty if there are none.
    bearing_acceleration : (b, 3, T) array
        Of a planet against its pin, in the frame of `bearing_force`; the rotation of a carrier's frame adds
        no terms. b = 0 if not requested.
    """

    time: FloatArray
    mesh: tuple[str, ...]
    shaft: tuple[str, ...]
    bearing: tuple[str, ...]
    freedom: tuple[str, ...]
    drive: tuple[str, ...]
    coupling: tuple[str, ...]
    position: FloatArray = field(
        metadata=stored("1", "position by the driving gear in base pitches, in [0, period)", *MESH)
    )
    mesh_frequency: FloatArray = field(metadata=stored("Hz", "mesh frequency of the mean motion", *MESH))
    dynamic_transmission_error: FloatArray = field(metadata=stored("m", "dynamic transmission error", *MESH))
    static_transmission_error: FloatArray = field(
        metadata=stored("m", "static transmission error at the nominal force", *MESH)
    )
    mesh_force: FloatArray = field(metadata=stored("N", "transverse mesh force", *MESH))
    coast_force: FloatArray = field(metadata=stored("N", "transverse force of the coast flank", *MESH))
    least_mesh_force: FloatArray = field(
        metadata=stored("N", "least mesh force between samples, unfiltered", *MESH)
    )
    largest_mesh_force: FloatArray = field(
        metadata=stored("N", "largest mesh force between samples, unfiltered", *MESH)
    )
    contact: FloatArray = field(
        metadata=stored("1", "flanks in contact: 0 none, 1 driving, 2 coast, 3 both", *MESH)
    )
    misalignment: FloatArray = field(metadata=stored("m", "misalignment at which the table was read", *MESH))
    center_distance_change: FloatArray = field(metadata=stored("m", "center-distance change likewise", *MESH))
    load_centroid: FloatArray = field(
        metadata=stored("m", "place of the mesh force from mid-face towards +z", *MESH)
    )
    speed: FloatArray = field(metadata=stored("rad s-1", "speed about +z", "shaft", "time"))
    drive_torque: FloatArray = field(metadata=stored("N m", "drive torque about +z", "drive", "time"))
    coupling_torque: FloatArray = field(
        metadata=stored("N m", "torque from the first to the second shaft", "coupling", "time")
    )
    bearing_force: FloatArray = field(metadata=stored("N", "force of the shaft on the ground", *BEARING))
    bearing_moment: FloatArray = field(metadata=stored("N m", "moment of the shaft on the ground", *BEARING))
    displacement: FloatArray = field(
        metadata=stored("m or rad", "deviation from the kinematic motion", *FREEDOM)
    )
    velocity: FloatArray = field(metadata=stored("m s-1 or rad s-1", "rate of the deviation", *FREEDOM))
    nominal_force: FloatArray = field(metadata=stored("N", "nominal transverse mesh force", "mesh"))
    status: RunStatus
    statistics: StepStatistics
    energy: EnergyAudit | None
    effect_ledger: Json = field(default_factory=dict)
    receipt: Json = field(default_factory=dict)
    case: Json = field(default_factory=dict)
    modes: Json = field(default_factory=dict)
    warnings: list[Json] = field(default_factory=list)
    acceleration: FloatArray = field(
        default_factory=lambda: np.empty((0, 0)),
        metadata=stored("m s-2 or rad s-2", "second rate of the deviation", *FREEDOM),
    )
    bearing_acceleration: FloatArray = field(
        default_factory=lambda: np.empty((0, 3, 0)),
        metadata=stored("m s-2", "acceleration of the shaft there", *BEARING),
    )

    @property
    def sample_rate(self) -> float:
        """Hz of the output grid."""
        return float(self.case["outputs"]["sample_rate"])

    def window(self, start: float, end: float) -> slice:
        """Return the samples with start <= time <= end (s).

        Raises
        ------
        InputError
            If fewer than 2 samples lie there.
        """
        first, last = np.searchsorted(self.time, [start, end * (1.0 + 1e-12)])
        if last - first < 2:
            run = Quantity(float(self.time[-1]), "s")
            bound = Text.of("inside the run, 0 to ", run, ", and longer than a sample")
            raise InputError("window", (start, end), bound)
        return slice(int(first), int(last))

    def to_xarray(self) -> xarray.Dataset:
        """Return the series as a dataset with units, the rest as JSON attributes."""
        from dynamics.results.run_files import to_dataset  # noqa: PLC0415 - xarray takes a second to import

        return to_dataset(self)

    def to_netcdf(self, path: str | Path) -> None:
        """Write a netCDF-4 file atomically, with lossless compression."""
        from dynamics.results.run_files import write_netcdf  # noqa: PLC0415

        write_netcdf(self, Path(path))

    @classmethod
    def from_netcdf(cls, path: str | Path) -> RunResult:
        """Read a file of `to_netcdf`; equal to the last bit.

        Raises
        ------
        ResultError
            If the file is no run result of this schema.
        """
        from dynamics.results.run_files import read_netcdf  # noqa: PLC0415

        return read_netcdf(Path(path))

    def to_csv(self, path: str | Path) -> None:
        """Write one row per sample, one column per series, units in the header."""
        from dynamics.results.run_files import write_csv  # noqa: PLC0415

        write_csv(self, Path(path))


NAMED = ("mesh", "shaft", "bearing", "freedom", "drive", "coupling")
"""Dimensions along which names stand, in the field of the same name."""
_STORED: dict[str, Stored] = {
    each.name: each.metadata["stored"] for each in fields(RunResult) if "stored" in each.metadata
}
OVER_TIME = {name: each for name, each in _STORED.items() if each.dimensions[-1] == "time"}
"""Series over time."""
SAMPLED = ("time", *OVER_TIME)
"""All that has one value per sample."""
SERIES = OVER_TIME | _STORED
"""All series of a result, in the order of its files."""
