"""The netCDF files of studies: what writes them, what reads them, and by what they are known."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce
from operator import or_
from pathlib import Path
from typing import Any

from dynamics.results.array_file import ArrayFile
from model_studies.record_file import read_record, write_record


@dataclass(frozen=True)
class ResultFile:
    """The netCDF file of a result.

    Attributes
    ----------
    attribute : str
        By which such a file is known.
    values : tuple of str
        That it has in such files.
    write, read : callable
        Result and path to the file, and back; `read` raises the libraries' errors or ValueError.
    result : type
        What `read` returns, as an annotation: the client's types are written from it.
    """

    attribute: str
    values: tuple[str, ...]
    write: Callable[[Any, Path], object]
    read: Callable[[Path], Any]
    result: Any

    def holds(self, attributes: Mapping[str, object]) -> bool:
        """Whether a file with these attributes is one."""
        return attributes.get(self.attribute) in self.values


def array_file(kind: type[ArrayFile]) -> ResultFile:
    """Return the file of a result of dynamics that has its own table of fields."""
    return ResultFile("schema", (kind.SCHEMA,), kind.to_netcdf, kind.from_netcdf, kind)


def record_file(*kinds: tuple[str, type]) -> ResultFile:
    """Return the file of dataclasses, which follows from their fields: what each is, and its type."""
    by_schema = {f"lineofaction {name}": kind for name, kind in kinds}

    def write(result: object, file: Path) -> None:
        schema = next(name for name, kind in by_schema.items() if type(result) is kind)
        write_record(result, file, schema)

    result = reduce(or_, by_schema.values())
    return ResultFile("schema", tuple(by_schema), write, lambda file: read_record(file, by_schema), result)
