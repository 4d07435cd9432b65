"""The content of a netCDF-4 file of ours: variables, attributes, and how they are written."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from host.directories import atomic_file

if TYPE_CHECKING:
    import xarray

_PACKED = {"compression": "gzip", "compression_opts": 4, "shuffle": True}
_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable."
"""Name that netCDF-4 gives to a dimension without coordinate, before its size in ten places."""


class Variable(NamedTuple):
    """An array of numbers, its dimensions, its attributes."""

    dimensions: tuple[str, ...]
    values: Any
    attributes: Mapping[str, Any]


@dataclass(frozen=True)
class NetcdfContent:
    """Content of a netCDF-4 file."""

    variables: Mapping[str, Variable]
    """Variables by name. A variable named as its only dimension is the coordinate along it."""
    attributes: Mapping[str, Any]
    """Attributes of the file: texts and numbers."""
    coordinates: tuple[str, ...] = ()
    """Names of variables that are coordinates of others under a different name, as a torque along the forces.
    """

    def to_xarray(self) -> xarray.Dataset:
        """Return the same as a dataset of xarray."""
        from host.optional_modules import xarray  # noqa: PLC0415 (named above for types)

        content = xarray.Dataset(dict(self.variables), attrs=dict(self.attributes))
        return content.set_coords(self.coordinates)

    def write(self, path: Path) -> None:
        """Write a netCDF-4 file; it appears whole or not at all.

        Its bytes are made in memory: where a disk is full, HDF5 would leave objects that crash the process
        later. Variables with entries are compressed, but for coordinates. A dimension without entries is
        unlimited, since netCDF has no other.
        """
        content = self._packed()
        with atomic_file(path) as draft, draft.open("wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())

    @property
    def sizes(self) -> dict[str, int]:
        """Sizes of the dimensions, in their order."""
        return {
            dimension: size
            for variable in self.variables.values()
            for dimension, size in zip(variable.dimensions, np.shape(variable.values), strict=True)
        }

    def _packed(self) -> bytes:
        import h5py  # noqa: PLC0415 - needed for files only

        with h5py.File.in_memory(track_order=True) as file:
            scales = {}
            for number, (name, size) in enumerate(self.sizes.items()):
                scales[name] = _scale(file, name, size, self.variables.get(name), number)
            for name, variable in self.variables.items():
                along_itself = variable.dimensions == (name,)
                dataset = scales[name] if along_itself else self._added(file, name, scales)
                describe(dataset, {**variable.attributes, **self._auxiliary(name)})
            describe(file, self.attributes)
            file.flush()
            image: bytes = file.id.get_file_image()
            return image

    def _added(self, file: Any, name: str, scales: Mapping[str, Any]) -> Any:
        """Add a variable that is not the coordinate along a dimension.

        One with the name of a dimension gets the prefix by which netCDF-4 tells it from a coordinate.
        """
        dimensions, values, _ = self.variables[name]
        values = np.asarray(values)
        packed = _PACKED if values.size and values.ndim and name not in self.coordinates else {}
        dataset = file.create_dataset(
            f"_nc4_non_coord_{name}" if name in scales else name,
            data=values,
            maxshape=_unlimited(values.shape),
            track_order=True,
            **packed,
        )
        for axis, dimension in enumerate(dimensions):
            dataset.dims[axis].attach_scale(scales[dimension])
        return dataset

    def _auxiliary(self, name: str) -> dict[str, str]:
        """Return the attribute ``coordinates`` of a variable, which names those that are no dimensions."""
        dimensions = set(self.variables[name].dimensions)
        along = [
            coordinate
            for coordinate in self.coordinates
            if dimensions.issuperset(self.variables[coordinate].dimensions)
        ]
        is_coordinate = name in self.coordinates or name in dimensions
        return {"coordinates": " ".join(along)} if along and not is_coordinate else {}


def _scale(file: Any, name: str, size: int, variable: Variable | None, number: int) -> Any:
    """Add a dimension: the coordinate along it, or a mark that there is none."""
    content: dict[str, Any] = {"dtype": ">f4"}
    scale_name = f"{_NO_VARIABLE}{size:10}"
    if variable is not None and variable.dimensions == (name,):
        content, scale_name = {"data": variable.values}, name
    scale = file.create_dataset(name, (size,), maxshape=_unlimited((size,)), track_order=True, **content)
    make_dimension(scale, number, scale_name)
    return scale


def _unlimited(shape: tuple[int, ...]) -> tuple[int | None, ...] | None:
    """Return the largest shape, with None for each empty dimension; None if no dimension is empty."""
    return None if all(shape) else tuple(size or None for size in shape)


def make_dimension(dataset: Any, number: int, scale_name: str) -> None:
    """Make a dataset of h5py the `number`-th dimension of its file."""
    dataset.make_scale(scale_name)
    dataset.attrs["_Netcdf4Dimid"] = np.int32(number)


def describe(target: Any, attributes: Mapping[str, Any]) -> None:
    """Write attributes of a file or dataset of h5py; netCDF stores a number as an array of one."""
    for name, value in attributes.items():
        target.attrs[name] = value if isinstance(value, str) else np.atleast_1d(value)
