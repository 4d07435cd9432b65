"""Sensitivity studies of pairs, and their netCDF-4 files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fe_contact.analysis.studies.sensitivity import RippleCurve, Sensitivity
from fe_contact.ste.netcdf import FileFormat, digest, json_attribute
from model_studies.netcdf import NetcdfContent, Variable

FORMAT = "lineofaction sensitivity study"
SCHEMA_VERSION = 1
_AXES = ("misalignment", "center_distance_change")

# dimensions, units and long name; the models are without and with corner contact
STORED: dict[str, tuple[tuple[str, ...], str, str]] = {
    "normal_force": (("pair",), "N", "normal tooth force F_bn"),
    "center_distance": (("pair",), "m", "nominal center distance"),
    "corner_contact": (("model",), "1", "1 with corner contact"),
    "misalignment": (("pair", "misaligned"), "m", "gap growth over the common face width"),
    "center_distance_change": (("pair", "changed"), "m", "deviation from the nominal center distance"),
    **{
        f"{name}_over_{axis}": (("pair", "model", along), "m", f"{text} over the {axis.replace('_', ' ')}")
        for axis, along in zip(_AXES, ("misaligned", "changed"), strict=True)
        for name, text in (
            ("peak_to_peak", "peak-to-peak static transmission error"),
            ("error", "half-width of the error band"),
        )
    },
}
FILES = FileFormat(FORMAT, "sensitivity study", SCHEMA_VERSION, tuple(STORED))


@dataclass(frozen=True)
class PairStudy:
    """The study of one pair.

    Attributes
    ----------
    name : str
    normal_force, center_distance : float
        N; m.
    curves : tuple of Sensitivity
        Without and with corner contact.
    """

    name: str
    normal_force: float
    center_distance: float
    curves: tuple[Sensitivity, ...]


def write_studies(studies: Sequence[PairStudy], path: Path) -> None:
    """Write studies of the same numbers of deviations: into a temporary file beside `path`, then renamed."""
    arrays = _arrays(studies)
    variables = {
        name: Variable(dimensions, arrays[name], {"units": units, "long_name": text})
        for name, (dimensions, units, text) in STORED.items()
    }
    attributes = {
        "Conventions": "CF-1.11",
        "title": "Sensitivity of the transmission error to misalignment and center distance",
        "format": FORMAT,
        "schema_version": np.int64(SCHEMA_VERSION),
        "names": json.dumps([study.name for study in studies]),
        "data_sha256": digest(arrays),
    }
    NetcdfContent(variables, attributes).write(path)


def read_studies(path: Path) -> tuple[PairStudy, ...]:
    """Read back what `write_studies` wrote.

    Raises
    ------
    DatabaseError
        The file is missing, no netCDF-4, of another kind, of a newer schema, or damaged.
    """
    content, attributes = FILES.read(path)
    names = json_attribute(path, attributes, "names")
    return tuple(_study(str(name), content, index) for index, name in enumerate(names))


def _arrays(studies: Sequence[PairStudy]) -> dict[str, Any]:
    """Stack the curves of all pairs."""
    models = studies[0].curves
    arrays: dict[str, Any] = {
        "normal_force": np.array([study.normal_force for study in studies]),
        "center_distance": np.array([study.center_distance for study in studies]),
        "corner_contact": np.array([curves.corner_contact for curves in models], dtype=np.int8),
    }
    for axis in _AXES:
        curves = [[getattr(each, axis) for each in study.curves] for study in studies]
        arrays[axis] = np.stack([row[0].deviation for row in curves])
        for name in ("peak_to_peak", "error"):
            stacked = [np.stack([getattr(curve, name) for curve in row]) for row in curves]
            arrays[f"{name}_over_{axis}"] = np.stack(stacked)
    return {name: arrays[name] for name in STORED}


def _study(name: str, content: dict[str, Any], pair: int) -> PairStudy:
    """Build one study again."""
    curves = tuple(
        Sensitivity(bool(corners), *(_curve(content, axis, pair, model) for axis in _AXES))
        for model, corners in enumerate(content["corner_contact"])
    )
    force, distance = (float(content[fact][pair]) for fact in ("normal_force", "center_distance"))
    return PairStudy(name, force, distance, curves)


def _curve(content: dict[str, Any], axis: str, pair: int, model: int) -> RippleCurve:
    sizes = (content[f"{name}_over_{axis}"][pair, model] for name in ("peak_to_peak", "error"))
    return RippleCurve(content[axis][pair], *sizes)
