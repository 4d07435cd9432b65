"""Results that are arrays and names as netCDF-4 files: one table of fields says what is stored how."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, ClassVar, Self

import h5netcdf
import numpy as np

from dynamics.errors import ResultError
from dynamics.types import Json

SCHEMA_VERSION = 1
PARTS = "part"  # dimension of the real and the imaginary part
DOCUMENTS = "documents"


@dataclass(frozen=True)
class Stored:
    """The storage of one array: its dimensions, its SI unit, its description."""

    dimensions: tuple[str, ...]
    units: str
    long_name: str


class ArrayFile:
    """A frozen dataclass of arrays, names and plain JSON that is kept as a netCDF-4 file.

    Attributes
    ----------
    SCHEMA : str
        What a file of it is.
    ARRAYS : mapping of str to Stored
        The fields that are arrays; all others are written as JSON.
    """

    SCHEMA: ClassVar[str]
    ARRAYS: ClassVar[Mapping[str, Stored]]

    def to_netcdf(self, path: str | Path) -> None:
        """Write a netCDF-4 file; it appears whole or not at all.

        Complex arrays get a last dimension of real and imaginary part.
        """
        _write(self, Path(path), self.SCHEMA, self.ARRAYS)

    @classmethod
    def from_netcdf(cls, path: str | Path) -> Self:
        """Read what `to_netcdf` wrote, bit by bit the same.

        Raises
        ------
        ResultError
            If the file is missing, no netCDF-4 file, of another schema, or damaged.
        """
        arrays, rest = _read(Path(path), cls.SCHEMA, cls.ARRAYS)
        try:
            return cls(**arrays, **rest)
        except TypeError as error:
            raise ResultError(f"{path}: damaged, {error!r}") from error


def _write(result: Any, path: Path, schema: str, stored: Mapping[str, Stored]) -> None:
    """Write the arrays in `stored`, and all other fields, of the dataclass `result`."""
    arrays = {name: np.asarray(getattr(result, name)) for name in stored}
    rest = {f.name: getattr(result, f.name) for f in fields(result) if f.name not in stored}
    documents = json.dumps({"shapes": _shapes(arrays), "fields": rest}, allow_nan=False)
    attributes = {
        "Conventions": "CF-1.11",
        "schema": schema,
        "schema_version": np.int64(SCHEMA_VERSION),
        DOCUMENTS: documents,
        "sha256": _digest(documents, arrays),
    }
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
    os.close(handle)
    part = Path(name)
    try:
        with h5netcdf.File(part, "w") as file:
            for key, values in arrays.items():
                _add(file, key, stored[key], values)
            for key, value in attributes.items():
                file.attrs[key] = value
        _publish(part, path)
    finally:
        part.unlink(missing_ok=True)


def _read(path: Path, schema: str, stored: Mapping[str, Stored]) -> tuple[Json, Json]:
    """Read the arrays and all other fields."""
    if not path.is_file():
        raise ResultError(f"{path}: no such file")
    try:
        with h5netcdf.File(path, "r") as file:
            attributes = dict(file.attrs)
            raw = {str(name): np.asarray(variable[...]) for name, variable in file.variables.items()}
    # what HDF5 raises on damaged bytes is not one class
    except (OSError, ValueError, KeyError, RuntimeError, TypeError, AttributeError, IndexError) as error:
        raise ResultError(f"{path}: not a readable netCDF-4 file ({error})") from error
    stated = f"{attributes.get('schema')} {attributes.get('schema_version')}"
    if stated != f"{schema} {SCHEMA_VERSION}":
        raise ResultError(f"{path}: schema is {stated}, expected {schema} {SCHEMA_VERSION}")
    try:
        documents = str(attributes[DOCUMENTS])
        content = json.loads(documents)
        arrays = {name: _restored(raw.get(name), content["shapes"][name]) for name in stored}
        if attributes["sha256"] != _digest(documents, arrays):
            raise ResultError(f"{path}: damaged, its contents do not match their checksum")
        return arrays, {name: _plain(value) for name, value in content["fields"].items()}
    except (KeyError, ValueError, TypeError) as error:
        raise ResultError(f"{path}: damaged, {error!r}") from error


def _shapes(arrays: Mapping[str, Any]) -> Json:
    """Type and shape of every array: those without entries are in no variable."""
    return {name: [values.dtype.str, list(values.shape)] for name, values in arrays.items()}


def _add(file: Any, name: str, stored: Stored, values: Any) -> None:
    """Write one array, if it has entries."""
    if not values.size:
        return
    dimensions = stored.dimensions
    if np.iscomplexobj(values):
        dimensions = (*dimensions, PARTS)
        values = np.stack([values.real, values.imag], axis=-1)
    for dimension, size in zip(dimensions, values.shape, strict=True):
        if dimension not in file.dimensions:
            file.dimensions[dimension] = size
    variable = file.create_variable(
        name, dimensions, values.dtype, compression="gzip", compression_opts=4, shuffle=True
    )
    variable[...] = values
    variable.attrs.update({"units": stored.units, "long_name": stored.long_name})


def _restored(values: Any, kind: list[Any]) -> Any:
    """Return an array as it was."""
    dtype, shape = np.dtype(kind[0]), tuple(kind[1])
    if values is None:
        return np.empty(shape, dtype=dtype)
    if dtype.kind == "c":
        whole = np.empty(shape, dtype=dtype)
        whole.real, whole.imag = values[..., 0], values[..., 1]
        return whole
    return np.ascontiguousarray(values.astype(dtype, copy=False)).reshape(shape)


def _plain(value: Any) -> Any:
    """Return a value of the documents: lists are tuples of names."""
    return tuple(value) if isinstance(value, list) else value


def _digest(documents: str, arrays: Mapping[str, Any]) -> str:
    """SHA-256 over the documents and all arrays in their order."""
    hasher = hashlib.sha256(documents.encode())
    for name, values in arrays.items():
        hasher.update(name.encode())
        hasher.update(np.ascontiguousarray(values).tobytes())
    return hasher.hexdigest()


def _publish(part: Path, path: Path) -> None:
    """Flush to disk and rename, with ordinary permissions."""
    mask = os.umask(0)
    os.umask(mask)
    part.chmod(0o666 & ~mask)
    with part.open("rb") as written:
        os.fsync(written.fileno())
    part.replace(path)
