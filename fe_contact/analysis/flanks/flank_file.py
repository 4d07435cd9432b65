"""Files of flank results in netCDF-4, with the contact patterns for other readers."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from fe_contact.analysis.flanks.contact_pattern import contact_pattern
from fe_contact.analysis.flanks.flank_scene import FlankScene
from fe_contact.analysis.flanks.load_distribution import FlankErrors, LoadDistribution
from fe_contact.errors import DatabaseError
from fe_contact.ste import Metadata
from fe_contact.ste.netcdf import FileFormat, digest, json_attribute
from fe_contact.types import Json
from model_studies.netcdf_content import NetcdfContent, Variable

if TYPE_CHECKING:
    from fe_contact.analysis.flanks.load_distribution import LoadDistribution

FORMAT = "lineofaction flank results"
SCHEMA_VERSION = 2
_GRID = ("position", "pair", "face_position")
_GEARS: tuple[Literal["pinion"], Literal["wheel"]] = ("pinion", "wheel")
_SCALARS, _DOCUMENTS = ("slice_width", "base_helix_angle"), ("scene", "metadata")
_NO_ERRORS = FlankErrors(reason="the file is older than errors of flanks")

# dimensions, units and long name of what is read back
STORED: dict[str, tuple[tuple[str, ...], str, str]] = {
    "position": (("position",), "1", "phase of the driving gear in transverse base pitches, 0 = pitch point"),
    "pair": (("pair",), "1", "index of the tooth pair, +1 is ahead"),
    "face_position": (("face_position",), "m", "middle of the stretch, distance from the pinion's mid-face"),
    "deflection": (("position",), "m", "static transmission error"),
    "roll_length_1": (_GRID, "m", "roll length on the driving gear"),
    "roll_length_2": (_GRID, "m", "roll length on the driven gear"),
    "on_path": (_GRID, "1", "1 where any of it is between A and E"),
    "force": (_GRID, "N", "normal force of the stretch"),
    "lever": (_GRID, "1", "lever arm about the driving gear over its base radius"),
    "pressure": (_GRID, "Pa", "peak Hertz pressure"),
    "gap": (_GRID, "m", "gap between the loaded flanks, infinite where they cannot touch"),
}
_EDGE: dict[str, tuple[tuple[str, ...], str, str]] = {
    "at_edge": (_GRID, "1", "1 where the strip reaches an edge of either flank")
}
"""Absent from older files."""
FILES = FileFormat(
    FORMAT, "flank results", SCHEMA_VERSION, tuple(STORED), (*_SCALARS, *_DOCUMENTS), tuple(_EDGE)
)


def content(results: LoadDistribution) -> NetcdfContent:
    """Return the content of a file: flank results with line load, centroid, factors and contact patterns."""
    arrays = _arrays(results)
    variables = {
        name: Variable(dimensions, arrays[name], {"units": units, "long_name": text})
        for name, (dimensions, units, text) in (STORED | _EDGE).items()
    }
    for gear in _GEARS:
        pattern = contact_pattern(results, gear)
        along = f"pattern_roll_length_{gear}"
        text = {"units": "m", "long_name": f"roll length on the {gear}, middles of cells"}
        variables[along] = Variable((along,), pattern.roll_length, text)
        text = {"units": "Pa", "long_name": f"largest pressure on the {gear}'s flank over the positions"}
        variables[f"contact_pattern_{gear}"] = Variable((along, "face_position"), pattern.pressure, text)
    return NetcdfContent(variables | _derived(results), _attributes(results, arrays))


def read(path: Path) -> dict[str, Any]:
    """Read the fields of a `LoadDistribution`.

    Raises `DatabaseError`: the file is missing, no netCDF-4, of another kind, of a newer schema, or damaged.
    """
    content, attributes = FILES.read(path)
    scene, metadata = (json_attribute(path, attributes, name) for name in _DOCUMENTS)
    return content | {
        "on_path": content["on_path"].astype(bool),
        "at_edge": content["at_edge"].astype(bool) if "at_edge" in content else False,
        "scene": FlankScene.from_json(scene),
        "metadata": Metadata(**metadata),
        "errors": _errors(path, attributes),
        **{name: float(attributes[name]) for name in _SCALARS},
    }


def _errors(path: Path, attributes: Json) -> FlankErrors:
    """Return the errors of a file; `DatabaseError`: they are something else."""
    if "errors" not in attributes:
        return _NO_ERRORS
    try:
        return FlankErrors(**json_attribute(path, attributes, "errors"))
    except TypeError as error:
        raise DatabaseError(f"{path.name}: damaged, its errors are not those of flanks") from error


def _arrays(results: LoadDistribution) -> dict[str, Any]:
    """Return the arrays of a file that are read back, in its order; netCDF has no booleans."""
    arrays = {name: getattr(results, name) for name in STORED}
    edge = np.broadcast_to(results.at_edge, results.force.shape)
    return arrays | {"on_path": results.on_path.astype(np.int8), "at_edge": edge.astype(np.int8)}


def _derived(results: LoadDistribution) -> dict[str, Variable]:
    """Return derived arrays of a file, for readers without this library."""
    along = ("position",)
    centroid = {"units": "m", "long_name": "along the face"}
    per_width = {"units": "N m-1", "long_name": "force of all pairs per face width"}
    return {
        "line_load": Variable(
            _GRID, results.line_load, {"units": "N m-1", "long_name": "force per contact line"}
        ),
        "face_load": Variable(("position", "face_position"), results.face_load, per_width),
        "load_centroid": Variable(along, results.load_centroid, centroid),
        "face_load_factor": Variable(along, results.face_load_factor, {"units": "1", "long_name": "K_Hbeta"}),
    }


def _attributes(results: LoadDistribution, arrays: dict[str, Any]) -> Json:
    return {
        "Conventions": "CF-1.11",
        "title": "Load and pressure on the flanks of a gear pair",
        "format": FORMAT,
        "schema_version": np.int64(SCHEMA_VERSION),
        "content_hash": results.metadata.content_hash,
        "mean_face_load_factor": results.mean_face_load_factor,
        "errors": json.dumps(asdict(results.errors)),
        "scene": json.dumps(results.scene.to_json()),
        "metadata": json.dumps(asdict(results.metadata)),
        "warnings": json.dumps(results.metadata.warnings),
        **{name: getattr(results, name) for name in _SCALARS},
        "data_sha256": digest(arrays),
    }
