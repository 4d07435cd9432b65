"""Result files: netCDF-4 read without decoding, checked by a digest of their arrays."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fe_contact.errors import DatabaseError
from fe_contact.types import Json
from model_studies.netcdf_input import UnreadableFile, opened


def _read_variables(path: Path) -> tuple[dict[str, Any], Json]:
    """Return all variables and global attributes of a netCDF-4 file, undecoded.

    Raises
    ------
    DatabaseError
        The file is missing or no netCDF-4.
    """
    import h5netcdf  # noqa: PLC0415 - needed for files only

    try:
        # arrays by h5py: h5netcdf looks for unwritten ends of unlimited dimensions, at several times the cost
        with opened(path) as content, h5netcdf.File(content.id, "r") as file:
            arrays = {
                str(name): np.asarray((variable if _is_text(content[name]) else content[name])[...])
                for name, variable in file.variables.items()
            }
            return arrays, dict(file.attrs)
    except UnreadableFile as error:
        raise DatabaseError(str(error)) from error


def _is_text(dataset: Any) -> bool:
    """Whether a variable holds texts, which h5netcdf decodes."""
    return bool(dataset.dtype.kind in "OS")


@dataclass(frozen=True)
class FileFormat:
    """A kind of result files, as what it must hold.

    Attributes
    ----------
    name : str
        The attribute ``format``.
    content : str
        What it holds, in words.
    schema_version : int
        The newest that is read.
    arrays, attributes : tuple of str
        Those that every file has; the checksum is over the arrays in their order.
    optional : tuple of str
        Arrays that some have.
    """

    name: str
    content: str
    schema_version: int
    arrays: tuple[str, ...]
    attributes: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()

    def read(self, path: Path, before: Callable[[Json], str] = lambda _: "") -> tuple[dict[str, Any], Json]:
        """Return the arrays and the attributes of a file; the checksum is over `before` of these, too.

        Raises
        ------
        DatabaseError
            The file is missing, no netCDF-4, of another kind, of a newer schema, or damaged.
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
    """SHA-256 over the text `before`, and names, types, shapes and bytes of the arrays, in their order."""
    hasher = hashlib.sha256(before.encode())
    for name, values in arrays.items():
        array = np.ascontiguousarray(values)
        hasher.update(f"{name} {array.dtype.newbyteorder('<').str} {array.shape};".encode())
        hasher.update(array.astype(array.dtype.newbyteorder("<"), copy=False).tobytes())
    return hasher.hexdigest()
