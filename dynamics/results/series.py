"""The series of a result: dimensions, units, names. One table that every export reads."""

from __future__ import annotations

from dataclasses import dataclass

LABELS = {
    "mesh": "mesh",
    "shaft": "shaft",
    "bearing": "bearing",
    "freedom": "freedom",
    "drive": "drive",
    "coupling": "coupling",
}


@dataclass(frozen=True)
class Series:
    """One stored array.

    Attributes
    ----------
    name : str
        Field of `RunResult`.
    dimensions : tuple of str
    units : str
    long_name : str
    """

    name: str
    dimensions: tuple[str, ...]
    units: str
    long_name: str


SERIES = (
    Series(
        "position",
        ("mesh", "time"),
        "1",
        "position by the driving gear in base pitches, in [0, period)",
    ),
    Series("mesh_frequency", ("mesh", "time"), "Hz", "mesh frequency of the mean motion"),
    Series("dynamic_transmission_error", ("mesh", "time"), "m", "dynamic transmission error"),
    Series(
        "static_transmission_error", ("mesh", "time"), "m", "static transmission error at the nominal force"
    ),
    Series("mesh_force", ("mesh", "time"), "N", "transverse mesh force"),
    Series("coast_force", ("mesh", "time"), "N", "transverse force of the coast flank"),
    Series("least_mesh_force", ("mesh", "time"), "N", "least mesh force between samples, unfiltered"),
    Series("largest_mesh_force", ("mesh", "time"), "N", "largest mesh force between samples, unfiltered"),
    Series("contact", ("mesh", "time"), "1", "flanks in contact: 0 none, 1 driving, 2 coast, 3 both"),
    Series("misalignment", ("mesh", "time"), "m", "misalignment at which the table was read"),
    Series("center_distance_change", ("mesh", "time"), "m", "center-distance change likewise"),
    Series("load_centroid", ("mesh", "time"), "m", "place of the mesh force from mid-face towards +z"),
    Series("speed", ("shaft", "time"), "rad s-1", "speed about +z"),
    Series("drive_torque", ("drive", "time"), "N m", "drive torque about +z"),
    Series("coupling_torque", ("coupling", "time"), "N m", "torque from the first to the second shaft"),
    Series("bearing_force", ("bearing", "direction", "time"), "N", "force of the shaft on the ground"),
    Series("bearing_moment", ("bearing", "direction", "time"), "N m", "moment of the shaft on the ground"),
    Series("displacement", ("freedom", "time"), "m or rad", "deviation from the kinematic motion"),
    Series("velocity", ("freedom", "time"), "m s-1 or rad s-1", "rate of the deviation"),
    Series("acceleration", ("freedom", "time"), "m s-2 or rad s-2", "second rate of the deviation"),
    Series(
        "bearing_acceleration", ("bearing", "direction", "time"), "m s-2", "acceleration of the shaft there"
    ),
    Series("nominal_force", ("mesh",), "N", "nominal transverse mesh force"),
)


def over_time() -> tuple[str, ...]:
    """Return the names of everything that has one value per sample, the time first."""
    return ("time", *(series.name for series in SERIES if series.dimensions[-1] == "time"))
