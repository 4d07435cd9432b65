"""netCDF files, read from foreign bytes and checked, and written."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from host.directories import whole_file

if TYPE_CHECKING:
    import xarray


# netCDF-4 files that are read: nothing in them lies in another file, or loads one.
#
# HDF5 lets a file name others: for the values of a dataset, for the parts of a virtual one, behind links and
# references, and as libraries that unpack it. A file comes from anyone, so it is walked before it is read.

MOST_VARIABLES = 4096
MOST_ATTRIBUTES = 256
MOST_ENTRIES = 32
"""Of an attribute of texts or lists, as of dimensions in HDF5: all may point to one long text."""
FREE_BYTES = 2**30
"""Of values and texts, which any file may unpack to."""
UNPACKED = 100
"""Bytes of values and texts per byte of a larger file."""
DAMAGE = (OSError, ValueError, KeyError, RuntimeError, TypeError, AttributeError, IndexError, MemoryError)
"""What HDF5, its readers and a record of foreign fields raise is not one class."""

_PACKED = {"compression": "gzip", "compression_opts": 4, "shuffle": True}
_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable."


class UnreadableFile(ValueError):
    """A file is missing, no netCDF-4, of another schema, damaged, or reaches out of itself."""


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """Open a netCDF-4 file as `h5py.File` for reading; an error of HDF5 within is damage of the file.

    It holds variables of numbers and texts in one group, plain or packed by deflate, shuffle and fletcher32.
    From here on HDF5 loads no plug-ins in this process.

    Raises `UnreadableFile`: the file is missing, no netCDF-4, damaged, holds something else, or unpacks to
    too much.
    """
    import h5py  # noqa: PLC0415 - needed for files only

    if not path.is_file():
        raise UnreadableFile(f"{path.name}: no such file")
    while h5py.h5pl.size():
        h5py.h5pl.remove(0)
    try:
        with h5py.File(path, "r") as file:
            _check(file, max(FREE_BYTES, UNPACKED * path.stat().st_size))
            yield file
    except UnreadableFile as error:
        raise UnreadableFile(f"{path.name}: {error}") from None
    except DAMAGE as error:
        raise UnreadableFile(f"{path.name}: not a readable netCDF-4 file") from error


@contextmanager
def opened_netcdf(path: Path, **decoding: Any) -> Iterator[Any]:
    """Open a file as `h5netcdf.File`; raises as `opened`."""
    import h5netcdf  # noqa: PLC0415 - needed for files only

    with opened(path) as content, h5netcdf.File(content.id, "r", **decoding) as file:
        yield file


def read_dataset(path: Path, **decoding: Any) -> xarray.Dataset:
    """Return a file as a dataset of xarray in memory; raises as `opened`."""
    import xarray  # noqa: PLC0415 - a second, and not needed by other readers
    from xarray.backends import H5NetCDFStore  # noqa: PLC0415

    with opened_netcdf(path, decode_vlen_strings=True) as file:
        return xarray.load_dataset(H5NetCDFStore(file), **decoding)


def _check(file: Any, most: int) -> None:
    """Refuse what is no variable of the file itself, and more than so many bytes of values and texts."""
    total = 0
    for size in _sizes(file):
        total += size
        if total > most:
            raise UnreadableFile(f"unpacks to more than {most} bytes")


def _sizes(file: Any) -> Iterator[int]:
    """Yield the unpacked sizes of values and texts of a file, in bytes, part by part."""
    from h5py import h5d, h5o  # noqa: PLC0415 - needed for files only

    root = file["/"].id
    yield from _attribute_sizes(root)
    for name in _names(root):
        variable = h5o.open(root, name)
        if not isinstance(variable, h5d.DatasetID):
            raise UnreadableFile("holds groups or types, and only variables are read")
        kind = variable.get_type()
        yield value_size(variable, kind)
        if _is_text(kind):
            texts = file[name]
            yield from (len(texts[entry]) for entry in np.ndindex(texts.shape))
        yield from _attribute_sizes(variable)


def _names(root: Any) -> list[bytes]:
    """Return the names of what a group holds; links to other places are refused."""
    from h5py import h5l  # noqa: PLC0415 - needed for files only

    if root.get_num_objs() > MOST_VARIABLES:
        raise UnreadableFile(f"holds more than {MOST_VARIABLES} variables")
    kinds: dict[bytes, int] = {}
    root.links.iterate(lambda name, link: kinds.update({name: link.type}), info=True)
    if any(kind != h5l.TYPE_HARD for kind in kinds.values()):
        raise UnreadableFile("holds links to other places or files")
    return list(kinds)


def value_size(variable: Any, kind: Any) -> int:
    """Return the unpacked size of a variable's values; what is not in the file itself is refused."""
    from h5py import h5d, h5z  # noqa: PLC0415 - needed for files only

    made = variable.get_create_plist()
    if made.get_layout() not in (h5d.COMPACT, h5d.CONTIGUOUS, h5d.CHUNKED) or made.get_external_count():
        raise UnreadableFile("has values that lie in other files")
    filters = [made.get_filter(index)[0] for index in range(made.get_nfilters())]
    known = {h5z.FILTER_DEFLATE, h5z.FILTER_SHUFFLE, h5z.FILTER_FLETCHER32}
    if not known.issuperset(filters) or len(set(filters)) < len(filters):
        raise UnreadableFile("is packed in another way than by deflate, shuffle and fletcher32")
    if not _is_plain(kind):
        raise UnreadableFile("has values that are neither numbers nor texts")
    chunk = made.get_chunk() if made.get_layout() == h5d.CHUNKED else ()
    entries = max(math.prod(variable.get_space().get_simple_extent_dims()), math.prod(chunk))
    size: int = entries * kind.get_size()
    return size


def _attribute_sizes(owner: Any) -> Iterator[int]:
    """Yield the sizes of attributes; references to other files or to parts of variables are refused."""
    from h5py import h5a, h5t, string_dtype  # noqa: PLC0415 - needed for files only

    count = h5a.get_num_attrs(owner)
    if count > MOST_ATTRIBUTES:
        raise UnreadableFile(f"has more than {MOST_ATTRIBUTES} attributes in one place")
    for index in range(count):
        attribute = h5a.open(owner, index=index)
        kind, size = attribute.get_type(), attribute.get_storage_size()
        entries = size // kind.get_size()
        if not _is_plain(kind) and not all(part.equal(h5t.STD_REF_OBJ) for part in _parts(kind)):
            raise UnreadableFile("has attributes that are neither numbers, texts nor dimensions")
        if entries > MOST_ENTRIES and (_is_text(kind) or kind.get_class() == h5t.VLEN):
            raise UnreadableFile(f"has more than {MOST_ENTRIES} texts in an attribute")
        if _is_text(kind):
            texts = np.empty(attribute.shape, dtype=string_dtype())
            attribute.read(texts)
            size += sum(map(len, texts.flat))
        yield size


def _is_plain(kind: Any) -> bool:
    """Whether a type is of numbers or texts."""
    from h5py import h5t  # noqa: PLC0415 - needed for files only

    return kind.get_class() in (h5t.INTEGER, h5t.FLOAT, h5t.STRING, h5t.ENUM)


def _is_text(kind: Any) -> bool:
    """Whether a type is of texts of any length, which lie apart."""
    from h5py import h5t  # noqa: PLC0415 - needed for files only

    return bool(kind.get_class() == h5t.STRING and kind.is_variable_str())


def _parts(kind: Any) -> list[Any]:
    """Return what a list or a record refers by, else the type itself; records number what they refer to."""
    from h5py import h5t  # noqa: PLC0415 - needed for files only

    if isinstance(kind, h5t.TypeCompoundID):
        members = [kind.get_member_type(index) for index in range(kind.get_nmembers())]
        return [member for member in members if member.get_class() != h5t.INTEGER]
    return [kind.get_super()] if kind.get_class() == h5t.VLEN else [kind]


class Variable(NamedTuple):
    """An array of numbers, its dimensions, its attributes."""

    dimensions: tuple[str, ...]
    values: Any
    attributes: Mapping[str, Any]


@dataclass(frozen=True)
class NetcdfContent:
    """The content of a file."""

    variables: Mapping[str, Variable]
    """By name. One that is called as its only dimension is the coordinate along it."""
    attributes: Mapping[str, Any]
    """Of the file: texts and numbers."""
    coordinates: tuple[str, ...] = ()
    """Variables that are coordinates of others and have a name of their own, as a torque along the forces."""

    def to_xarray(self) -> xarray.Dataset:
        """Return the same as a dataset of xarray."""
        import xarray  # noqa: PLC0415 - half a second, and not needed to write a file

        content = xarray.Dataset(dict(self.variables), attrs=dict(self.attributes))
        return content.set_coords(self.coordinates)

    def write(self, path: Path) -> None:
        """Write a netCDF-4 file; it appears whole or not at all.

        Its bytes are made in memory: where a disk is full, HDF5 would leave objects that crash the process
        later. Variables with entries are compressed, but for coordinates. A dimension without entries is
        unlimited, since netCDF has no other.
        """
        content = self._packed()
        with whole_file(path) as draft, draft.open("wb") as stream:
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
        """Add a variable that is not the coordinate along a dimension; netCDF marks one called as another."""
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
        """Return the attribute that names coordinates beside those along the dimensions of a variable."""
        dimensions = set(self.variables[name].dimensions)
        along = [each for each in self.coordinates if dimensions.issuperset(self.variables[each].dimensions)]
        is_coordinate = name in self.coordinates or name in dimensions
        return {"coordinates": " ".join(along)} if along and not is_coordinate else {}


def _scale(file: Any, name: str, size: int, variable: Variable | None, number: int) -> Any:
    """Add a dimension: the coordinate along it, or a mark that there is none."""
    content: dict[str, Any] = {"dtype": ">f4"}
    called = f"{_NO_VARIABLE}{size:10}"
    if variable is not None and variable.dimensions == (name,):
        content, called = {"data": variable.values}, name
    scale = file.create_dataset(name, (size,), maxshape=_unlimited((size,)), track_order=True, **content)
    make_dimension(scale, number, called)
    return scale


def _unlimited(shape: tuple[int, ...]) -> tuple[int | None, ...] | None:
    """Return the largest shape, with None for dimensions without entries; None if there are none such."""
    return None if all(shape) else tuple(size or None for size in shape)


def make_dimension(dataset: Any, number: int, called: str) -> None:
    """Let a dataset of h5py be the `number`-th dimension of its file, called by its name if it has values."""
    dataset.make_scale(called)
    dataset.attrs["_Netcdf4Dimid"] = np.int32(number)


def describe(target: Any, attributes: Mapping[str, Any]) -> None:
    """Write attributes of a file or dataset of h5py; numbers are rows in netCDF."""
    for name, value in attributes.items():
        target.attrs[name] = value if isinstance(value, str) else np.atleast_1d(value)
