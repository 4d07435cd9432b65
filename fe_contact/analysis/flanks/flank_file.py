"""Files of flank results in netCDF-4, with the contact patterns for other readers."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any, Literal

import numpy as np

from fe_contact.analysis.flanks.contact_pattern import contact_pattern
from fe_contact.analysis.flanks.flank_scene import FlankScene
from fe_contact.analysis.flanks.load_distribution import FlankErrors, LoadDistribution
from fe_contact.errors import DatabaseError
from fe_contact.ste import Metadata
from fe_contact.ste.netcdf import FileFormat, digest, json_attribute
from fe_contact.types import Json
from model_studies.netcdf_content import NetcdfContent, Variable

FORMAT = "lineofaction flank results"
SCHEMA_VERSION = 2
_GRID = ("position", "pair", "face_position")
_GEARS: tuple[Literal["pinion"], Literal["wheel"]] = ("pinion", "wheel")
_SCALARS = ("slice_width", "base_helix_angle")
_DOCUMENTS = ("scene", "metadata")
_NO_ERRORS = FlankErrors(reason="the file is older than errors of flanks")

# dimensions, units and long name of the arrays that are read back
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
"""Arrays that older files lack."""
FILES = FileFormat(
    FORMAT, "flank results", SCHEMA_VERSION, tuple(STORED), (*_SCALARS, *_DOCUMENTS), tuple(_EDGE)
)


def content(results: LoadDistribution) -> NetcdfContent:
    """Return the content of a file: flank results with line load, centroid, factors and contact patterns."""
    arrays = _arrays(results)
    variables = {
        name: _variable(dimensions, arrays[name], units, long_name)
        for name, (dimensions, units, long_name) in (STORED | _EDGE).items()
    }
    for gear in _GEARS:
        pattern = contact_pattern(results, gear)
        axis = f"pattern_roll_length_{gear}"
        text = f"roll length on the {gear}, middles of cells"
        variables[axis] = _variable((axis,), pattern.roll_length, "m", text)
        text = f"largest pressure on the {gear}'s flank over the positions"
        cells = (axis, "face_position")
        variables[f"contact_pattern_{gear}"] = _variable(cells, pattern.pressure, "Pa", text)
    return NetcdfContent(variables | _derived(results), _attributes(results, arrays))


def _variable(dimensions: tuple[str, ...], values: Any, units: str, long_name: str) -> Variable:
    return Variable(dimensions, values, {"units": units, "long_name": long_name})


def read(path: Path) -> dict[str, Any]:
    """Read the fields of a `LoadDistribution`.

    Raises `DatabaseError`: the file is missing, no netCDF-4, of another kind, of a newer schema, or damaged.
    """
    content, attributes = FILES.read(path)
    return content | {
        "on_path": content["on_path"].astype(bool),
        "at_edge": content["at_edge"].astype(bool) if "at_edge" in content else False,
        "scene": FlankScene.from_json(json_attribute(path, attributes, "scene")),
        "metadata": Metadata(**json_attribute(path, attributes, "metadata")),
        "errors": _errors(path, attributes),
        **{name: float(attributes[name]) for name in _SCALARS},
    }


def _errors(path: Path, attributes: Json) -> FlankErrors:
    """Return the errors of a file. Raises `DatabaseError`: they have other fields than `FlankErrors`."""
    if "errors" not in attributes:
        return _NO_ERRORS
    try:
        return FlankErrors(**json_attribute(path, attributes, "errors"))
    except TypeError as error:
        raise DatabaseError(f"{path.name}: damaged, its errors are not those of flanks") from error


def _arrays(results: LoadDistribution) -> dict[str, Any]:
    """Return the arrays of a file that are read back, in its order; integers, as netCDF has no booleans."""
    arrays = {name: getattr(results, name) for name in STORED}
    edge = np.broadcast_to(results.at_edge, results.force.shape)
    return arrays | {"on_path": results.on_path.astype(np.int8), "at_edge": edge.astype(np.int8)}


def _derived(results: LoadDistribution) -> dict[str, Variable]:
    """Return derived arrays of a file, for readers without this library."""
    position, face = ("position",), ("position", "face_position")
    text = "force of all pairs per face width"
    return {
        "line_load": _variable(_GRID, results.line_load, "N m-1", "force per contact line"),
        "face_load": _variable(face, results.face_load, "N m-1", text),
        "load_centroid": _variable(position, results.load_centroid, "m", "along the face"),
        "face_load_factor": _variable(position, results.face_load_factor, "1", "K_Hbeta"),
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
