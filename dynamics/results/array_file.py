"""Results that are arrays and names as netCDF-4 files: each field declares how it is stored."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from dynamics.errors import ResultError
from dynamics.types import Json
from model_studies.array_file import Stored, arrays_content, read_arrays
from model_studies.netcdf import UnreadableFile
from model_studies.netcdf_content import NetcdfContent
from model_studies.record import key_of

if TYPE_CHECKING:
    import xarray


def stored(units: str, text: str, *dimensions: str) -> dict[str, Stored]:
    """Return the metadata of a field that is an array of a file: SI unit, description, dimensions."""
    return {"stored": Stored(dimensions, units, text)}


class ArrayFile:
    """A frozen dataclass of arrays, names, records and plain JSON that is kept as a netCDF-4 file.

    Fields with the metadata `stored` are arrays; all others are written as JSON, by the name of the field or
    the `under_key` of its metadata.
    """

    SCHEMA: ClassVar[str]
    """Name of the kind of result, which a file states."""
    RECORDS: ClassVar[Mapping[str, Callable[[Json], Any]]] = {}
    """Fields that are dataclasses, each with the function that makes it from JSON."""

    @classmethod
    def arrays(cls) -> dict[str, Stored]:
        """Return the declaration of storage of each field that is an array."""
        items = fields(cls)  # type: ignore[arg-type]
        return {item.name: item.metadata["stored"] for item in items if "stored" in item.metadata}

    def to_netcdf(self, path: str | Path) -> None:
        """Write a netCDF-4 file; it appears whole or not at all.

        Complex arrays get a last dimension of real and imaginary part.
        """
        self._content().write(Path(path))

    def to_xarray(self) -> xarray.Dataset:
        """Return the content of the file as arrays with names and units; what is no array is an attribute."""
        return self._content().to_xarray()

    def _content(self) -> NetcdfContent:
        values = {item.name: getattr(self, item.name) for item in fields(self)}  # type: ignore[arg-type]
        kinds = self.arrays()
        arrays = {name: np.asarray(values.pop(name)) for name in kinds}
        values |= {name: asdict(values[name]) for name in self.RECORDS}
        keys = self._keys()
        rest = {keys[name]: value for name, value in values.items()}
        return arrays_content(self.SCHEMA, kinds, arrays, rest)

    @classmethod
    def from_netcdf(cls, path: str | Path) -> Self:
        """Read a file of `to_netcdf`, bit by bit the same.

        Raises `ResultError`: the file is missing, no netCDF-4 file, of another schema, or damaged.
        """
        try:
            _, arrays, rest = read_arrays(Path(path), (cls.SCHEMA,))
            names = {key: name for name, key in cls._keys().items()}
            values = {names.get(key, key): value for key, value in rest.items()}
            return cls(**arrays, **{name: cls._field(name, value) for name, value in values.items()})
        except UnreadableFile as error:
            raise ResultError(str(error)) from error
        except (TypeError, KeyError) as error:
            raise ResultError(f"{Path(path).name}: damaged, its fields are others") from error

    @classmethod
    def _keys(cls) -> dict[str, str]:
        """Return the names of all fields in files."""
        return {item.name: key_of(item) for item in fields(cls)}  # type: ignore[arg-type]

    @classmethod
    def _field(cls, name: str, value: Any) -> Any:
        if name in cls.RECORDS:
            return cls.RECORDS[name](value)
        return tuple(value) if isinstance(value, list) else value
