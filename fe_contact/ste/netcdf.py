"""STE databases as netCDF-4 files.

The errors of a curve have an axis of sources (`SOURCES`) and one of quantities; `OFF_MESH` is the index of
orders that are no mesh orders.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fe_contact.errors import DatabaseError
from fe_contact.ste.curve_errors import AT_NODES, METHOD, OF_LOAD_ARM, PLANE, SOURCES
from fe_contact.ste.curve_quantities import OFF_MESH
from fe_contact.ste.fields import DIMENSIONS, OPTIONAL, RESIDUALS, SteFields
from fe_contact.ste.metadata import SCHEMA_VERSION, Metadata, PairGeometry
from fe_contact.types import Json, Status
from model_studies.netcdf import UnreadableFile, opened
from model_studies.netcdf_content import NetcdfContent, Variable

FORMAT = "lineofaction STE database"
"""Value of the attribute ``format`` of the files."""
_OFF_MESH_SINCE = 4
"""Schema version since which errors have an entry for orders that are no mesh orders."""
WARNINGS = "warnings"
"""Name of the attribute with the warnings of the metadata."""
_JSON_ATTRIBUTES = ("case", "effect_ledger", "receipt", "software_versions")
# units and long names; "1" is CF's dimensionless
ATTRIBUTES: dict[str, tuple[str, str]] = {
    "position": (
        "1",
        "phase of the driving gear in base pitches (transverse), 0 = reference pair at the pitch point",
    ),
    "force": ("N", "total normal tooth force"),
    "torque": ("N m", "torque on the driving gear"),
    "misalignment": ("m", "tilt of the axes in the plane of action, as gap over the common face width"),
    "center_distance_change": ("m", "deviation from the nominal center distance"),
    "pair": ("1", "index of the tooth pair, counted anew at every whole pitch, 0 = reference pair"),
    "static_transmission_error": (
        "m",
        "static transmission error on the line of action, driven gear lags > 0",
    ),
    "tangent_compliance": ("m N-1", "derivative of the static transmission error in the normal tooth force"),
    "no_load_transmission_error": ("m", "transmission error at first contact"),
    "load_share": ("1", "part of the load carried by the tooth pair"),
    "face_centroid": ("m", "offset of the centroid of the load from mid-face"),
    "load_arm": ("m", "arm of the load about the axis of a misalignment"),
    "max_pressure": ("Pa", "largest contact pressure where no edge is reached"),
    "edge_pressure": ("Pa", "largest contact pressure at edges of flanks, as if they went on: indicative"),
    "pair_pressure": ("Pa", "largest contact pressure of the tooth pair where no edge is reached"),
    "pairs_in_contact": ("1", "number of tooth pairs that carry load"),
    "status": ("1", "outcome of the contact solve"),
    "error_estimate": ("m", "half-width of the error band of the static transmission error"),
    "curve_error": (
        "m",
        "error of mean, peak-to-peak, any order beside the mesh and harmonics 1 to 20, by source: "
        + ", ".join(SOURCES),
    ),
    "load_arm_error": (
        "m",
        "error of mean, peak-to-peak, any order beside the mesh and harmonics 1 to 20 of the load arm, "
        "by source: " + ", ".join(OF_LOAD_ARM),
    ),
    "interval_error": (
        "m",
        "largest error of the transmission error between each node and the next of the axes force, "
        "misalignment, center_distance_change",
    ),
    "misalignment_inserted": ("1", "1 where the node was inserted to meet a tolerance, 0 where requested"),
    "center_distance_inserted": ("1", "1 where the node was inserted to meet a tolerance, 0 where requested"),
    "support_force": (
        "N",
        "further loads that only carry the interpolation: those between two loads of the axis were inserted",
    ),
    "support_transmission_error": ("m", "static transmission error at the support loads"),
    "support_tangent_compliance": ("m N-1", "derivative of the transmission error at the support loads"),
    "support_pairs_in_contact": ("1", "number of tooth pairs that carry the support loads"),
    "residuals": ("1", "residuals of the contact solution: " + ", ".join(RESIDUALS)),
}


def _read_variables(path: Path) -> tuple[dict[str, Any], Json]:
    """Return all variables and global attributes of a netCDF-4 file, undecoded.

    Raises `DatabaseError`: the file is missing or no netCDF-4.
    """
    import h5netcdf  # noqa: PLC0415 - needed for files only

    try:
        # arrays by h5py: h5netcdf looks for unwritten ends of unlimited dimensions, at several times the cost
        # texts (kinds O and S) are by h5netcdf, which decodes them
        with opened(path) as content, h5netcdf.File(content.id, "r") as file:
            arrays = {
                str(name): np.asarray((variable if content[name].dtype.kind in "OS" else content[name])[...])
                for name, variable in file.variables.items()
            }
            return arrays, dict(file.attrs)
    except UnreadableFile as error:
        raise DatabaseError(str(error)) from error


@dataclass(frozen=True)
class FileFormat:
    """Kind of result files, declared by the arrays and attributes that it must hold."""

    name: str
    """Value of the attribute ``format``."""
    content: str
    """Content of the file, in words."""
    schema_version: int
    """Newest schema version that is read."""
    arrays: tuple[str, ...]
    attributes: tuple[str, ...] = ()
    """`arrays`, `attributes`: Names that every file has; the checksum is over the arrays in their order."""
    optional: tuple[str, ...] = ()
    """Names of arrays that some files have."""

    def read(self, path: Path, before: Callable[[Json], str] = lambda _: "") -> tuple[dict[str, Any], Json]:
        """Return the arrays and the attributes of a file.

        `before` returns, from the attributes, the text that the checksum begins with. Raises `DatabaseError`:
        the file is missing, no netCDF-4, of another kind, of a newer schema, or damaged.
        """
        arrays, attributes = _read_variables(path)
        if attributes.get("format") != self.name:
            raise DatabaseError(f"{path.name}: a netCDF file, but no {self.content}")
        version, newest = attributes.get("schema_version"), self.schema_version
        if not isinstance(version, int | np.integer) or not 1 <= version <= newest:
            known = "1" if newest == 1 else f"1 to {newest}"
            raise DatabaseError(
                f"{path.name}: schema version {version}, but this release reads {known}: update it"
            )
        missing = sorted((set(self.arrays) - set(arrays)) | (set(self.attributes) - set(attributes)))
        if missing:
            raise DatabaseError(f"{path.name}: damaged, without {', '.join(missing)}")
        content = {name: arrays[name] for name in (*self.arrays, *self.optional) if name in arrays}
        if attributes.get("data_sha256") != digest(content, before(attributes)):
            raise DatabaseError(f"{path.name}: damaged, its arrays do not match their checksum")
        return content, attributes


def json_attribute(path: Path, attributes: Json, name: str) -> Any:
    """Return the JSON document in an attribute; DatabaseError: there is none."""
    try:
        return json.loads(attributes[name])
    except (KeyError, TypeError, ValueError) as error:
        raise DatabaseError(f"{path.name}: damaged, its {name} is not readable JSON") from error


def digest(arrays: Mapping[str, Any], before: str = "") -> str:
    """Return the SHA-256 of the text `before`, and of name, type, shape and bytes of each array."""
    hasher = hashlib.sha256(before.encode())
    for name, values in arrays.items():
        array = np.ascontiguousarray(values)
        hasher.update(f"{name} {array.dtype.newbyteorder('<').str} {array.shape};".encode())
        hasher.update(array.astype(array.dtype.newbyteorder("<"), copy=False).tobytes())
    return hasher.hexdigest()


FILES = FileFormat(FORMAT, "STE database", SCHEMA_VERSION, tuple(DIMENSIONS), optional=tuple(OPTIONAL))


def content(database: SteFields) -> NetcdfContent:
    """Return the content of the database's file: CF-style names, units and coordinates."""
    variables = {
        name: Variable(database.stored[name], values, _described(name))
        for name, values in _stored(database).items()
    }
    return NetcdfContent(variables, _global_attributes(database), coordinates=("torque",))


def read(path: Path) -> dict[str, Any]:
    """Read the arrays, geometry and metadata of a file, by the names of `SteFields`.

    Raises `DatabaseError`: the file is missing, no netCDF-4, no STE database, of a newer schema, or damaged.
    """
    content, attributes = FILES.read(path, lambda attributes: _checksum_prefix(_period(path, attributes)))
    # files of schema version 1 have no errors of the method: they are 0 in their place among the sources
    if content.get("curve_error", np.empty(0)).shape[0] == len(SOURCES) - 1:
        content["curve_error"] = np.insert(content["curve_error"], AT_NODES.index(METHOD), 0.0, axis=0)
    for name in ("curve_error", "load_arm_error"):
        if attributes["schema_version"] < _OFF_MESH_SINCE and content.get(name, np.empty(0)).size:
            content[name] = np.insert(content[name], OFF_MESH, np.nan, axis=1)
    documents = {name: json_attribute(path, attributes, name) for name in _JSON_ATTRIBUTES}
    bias = documents["receipt"].get("bias") or {}  # only older files have one
    if bias.get("stated"):
        content |= _without_bias(content, bias["stated"])
    return content | {
        "geometry": _gear_pair(path, attributes),
        "metadata": Metadata(
            content_hash=str(attributes.get("content_hash", "")),
            schema_version=int(attributes["schema_version"]),
            warnings=json_attribute(path, {WARNINGS: "[]", **attributes}, WARNINGS),  # older files hold none
            **documents,
        ),
        "period": _period(path, attributes),
    }


def _without_bias(content: dict[str, Any], bias: float) -> dict[str, Any]:
    """Return the errors of an older file without the `bias` of its model in the plane, a share of the STE."""
    errors = content.get("curve_error", np.empty(0)).copy()
    errors[AT_NODES.index(PLANE) : AT_NODES.index(PLANE) + 1] = 0.0  # a slice: the array may be empty
    band = content["error_estimate"] - bias * np.abs(content["static_transmission_error"])
    return {"curve_error": errors, "error_estimate": np.maximum(band, 0.0)}


def _described(name: str) -> Json:
    units, long_name = ATTRIBUTES[name]
    attributes: Json = {"units": units, "long_name": long_name}
    if name == "status":
        attributes["flag_values"] = np.array([status.value for status in Status], dtype=np.int8)
        attributes["flag_meanings"] = " ".join(status.name.lower() for status in Status)
    return attributes


def _global_attributes(database: SteFields) -> Json:
    metadata = asdict(database.metadata)
    return {
        "Conventions": "CF-1.11",
        "title": "Static transmission error of a gear pair",
        "summary": database.summary(),
        "format": FORMAT,
        "schema_version": np.int64(database.metadata.schema_version),
        "content_hash": database.metadata.content_hash,
        "period": np.int64(database.period),
        "facts": json.dumps(database.geometry.to_json()),
        **{name: json.dumps(metadata[name]) for name in (*_JSON_ATTRIBUTES, WARNINGS)},
        "data_sha256": digest(_stored(database), _checksum_prefix(database.period)),
    }


def _stored(database: SteFields) -> dict[str, Any]:
    return {name: getattr(database, name) for name in database.stored}


def _period(path: Path, attributes: Json) -> int:
    """Return the period, base pitches; files without the attribute are older and have the period 1."""
    period = attributes.get("period", 1)
    if not isinstance(period, int | np.integer):
        raise DatabaseError(f"{path.name}: damaged, its period is {period!r}")
    return int(period)


def _checksum_prefix(period: int) -> str:
    """Return the text that the checksum begins with: the period if it is not 1."""
    return f"period {period};" if period != 1 else ""


def _gear_pair(path: Path, attributes: Json) -> PairGeometry:
    content = json_attribute(path, attributes, "facts")
    if not isinstance(content, dict):
        raise DatabaseError(f"{path.name}: damaged, its facts are no JSON object")
    return PairGeometry.from_json(content)
