"""Named arrays and plain JSON in a netCDF-4 file: written whole, checked by a digest when it is read."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bounds.types import Json
from model_studies.netcdf import DAMAGE, UnreadableFile, opened_netcdf
from model_studies.netcdf_content import NetcdfContent, Variable

SCHEMA_VERSION = 1
PARTS = "part"  # dimension of the real and the imaginary part
DOCUMENTS = "documents"
NUMBERS = "biufc"


@dataclass(frozen=True)
class Stored:
    """The storage of one array: its dimensions, its SI unit, its description."""

    dimensions: tuple[str, ...]
    units: str
    long_name: str


def arrays_content(
    schema: str, stored: Mapping[str, Stored], arrays: Mapping[str, Any], rest: Json
) -> NetcdfContent:
    """Return the content of a file of named arrays.

    Parameters
    ----------
    schema : str
        Name of the kind of file, its attribute ``schema``.
    stored, arrays : mapping
        Storage and values by name. A complex array gets a last dimension of real and imaginary part. An
        array without entries has no variable.
    rest : dict
        Further content, plain JSON.
    """
    # the shapes of all arrays, also of those without a variable
    shapes = {name: [values.dtype.str, list(values.shape)] for name, values in arrays.items()}
    documents = json.dumps({"shapes": shapes, "fields": rest}, allow_nan=False)
    attributes = {
        "Conventions": "CF-1.11",
        "schema": schema,
        "schema_version": np.int64(SCHEMA_VERSION),
        DOCUMENTS: documents,
        "sha256": _digest(documents, arrays),
    }
    sizes: dict[str, int] = {}  # of the dimensions by name, filled by `_variable`
    variables = {
        name: _variable(stored[name], values, sizes) for name, values in arrays.items() if values.size
    }
    return NetcdfContent(variables, attributes)


def read_arrays(path: Path, schemas: tuple[str, ...]) -> tuple[str, dict[str, Any], Json]:
    """Return the schema of a file, its arrays, bit by bit as written, and its further content.

    Raises `UnreadableFile`: the file is missing, no netCDF-4, of none of the schemas, or damaged.
    """
    with opened_netcdf(path) as file:
        attributes = dict(file.attrs)
        raw = {str(name): np.asarray(variable[...]) for name, variable in file.variables.items()}
    file_schema = f"{attributes.get('schema')} {attributes.get('schema_version')}"
    if file_schema not in [f"{schema} {SCHEMA_VERSION}" for schema in schemas]:
        raise UnreadableFile(
            f"{path.name}: schema is {file_schema}, expected {' or '.join(schemas)} {SCHEMA_VERSION}"
        )
    try:
        documents = str(attributes[DOCUMENTS])
        content = json.loads(documents)
        arrays = {
            name: _restored(raw.get(name), dtype, shape) for name, (dtype, shape) in content["shapes"].items()
        }
        intact, fields = attributes["sha256"] == _digest(documents, arrays), content["fields"]
    except DAMAGE as error:
        raise UnreadableFile(f"{path.name}: damaged, its arrays are not those that it states") from error
    if not intact:
        raise UnreadableFile(f"{path.name}: damaged, its contents do not match their checksum")
    return str(attributes["schema"]), arrays, fields


def _variable(stored: Stored, values: Any, sizes: dict[str, int]) -> Variable:
    """Return an array as a variable, and enter its dimensions into `sizes`."""
    dimensions = stored.dimensions
    if np.iscomplexobj(values):
        dimensions = (*dimensions, PARTS)
        values = np.ascontiguousarray(values)
        values = values.view(values.real.dtype).reshape(*values.shape, 2)  # no copy: responses are large
    names = tuple(_dimension(sizes, name, size) for name, size in zip(dimensions, values.shape, strict=True))
    return Variable(names, values, {"units": stored.units, "long_name": stored.long_name})


def _dimension(sizes: dict[str, int], name: str, size: int) -> str:
    """Return the name of a dimension, with its size at the end if another size has that name already."""
    if sizes.setdefault(name, size) != size:
        return _dimension(sizes, f"{name}_{size}", size)
    return name


def _restored(values: Any, type_text: str, shape: list[int]) -> Any:
    """Return an array of a type and shape from its variable, which is None for an empty array."""
    dtype = np.dtype(type_text)
    if dtype.kind not in NUMBERS:
        raise ValueError(dtype)
    if values is None:
        return np.empty(0, dtype=dtype).reshape(shape)
    if dtype.kind == "c":
        return np.ascontiguousarray(values).view(dtype).reshape(shape)
    return np.ascontiguousarray(values.astype(dtype, copy=False)).reshape(shape)


def _digest(documents: str, arrays: Mapping[str, Any]) -> str:
    """Return the SHA-256 of the documents and all arrays in their order."""
    hasher = hashlib.sha256(documents.encode())
    for name, values in arrays.items():
        hasher.update(name.encode())
        hasher.update(np.ascontiguousarray(values).data)
    return hasher.hexdigest()
