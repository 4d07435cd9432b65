"""Results that are arrays and names as netCDF-4 files: one table of fields says what is stored how."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np

from dynamics.errors import ResultError
from model_studies.array_file import Stored, read_arrays, write_arrays
from model_studies.netcdf import UnreadableFile

__all__ = ["ArrayFile", "Stored"]


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
        values = {each.name: getattr(self, each.name) for each in fields(self)}  # type: ignore[arg-type]
        arrays = {name: np.asarray(values.pop(name)) for name in self.ARRAYS}
        write_arrays(Path(path), self.SCHEMA, self.ARRAYS, arrays, values)

    @classmethod
    def from_netcdf(cls, path: str | Path) -> Self:
        """Read what `to_netcdf` wrote, bit by bit the same.

        Raises
        ------
        ResultError
            If the file is missing, no netCDF-4 file, of another schema, or damaged.
        """
        try:
            _, arrays, rest = read_arrays(Path(path), (cls.SCHEMA,))
            return cls(**arrays, **{name: _plain(value) for name, value in rest.items()})
        except UnreadableFile as error:
            raise ResultError(str(error)) from error
        except TypeError as error:
            raise ResultError(f"{Path(path).name}: damaged, its fields are others") from error


def _plain(value: Any) -> Any:
    """Return a value of the documents: lists are tuples of names."""
    return tuple(value) if isinstance(value, list) else value
