"""Reading of netCDF-4 files from unknown senders: a file that would make HDF5 open other files is refused.

HDF5 lets a file name others: for the values of a dataset, for the parts of a virtual dataset, behind links
and references, and as libraries that unpack it. So the structure of a file is checked before its values are
read.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray

MAX_VARIABLES = 4096
MAX_ATTRIBUTES = 256
MAX_ENTRIES = 32
"""Most entries of an attribute of texts or lists; HDF5 has the same limit of dimensions. The limit is needed
because all entries may point to one long text, which each of them would unpack again.
"""
FREE_BYTES = 2**30
"""Bytes of values and texts that any file may unpack to."""
UNPACKED = 100
"""Bytes of values and texts per byte of a larger file."""
DAMAGE = (OSError, ValueError, KeyError, RuntimeError, TypeError, AttributeError, IndexError, MemoryError)
"""Errors of damaged files. HDF5, its readers and a record of foreign fields have no common error class."""


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
    # Without folders of plug-ins HDF5 finds no library that a filter of the file could name.
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
    from host.optional_modules import xarray  # noqa: PLC0415 (named above for types)

    with opened_netcdf(path, decode_vlen_strings=True) as file:
        return xarray.load_dataset(xarray.backends.H5NetCDFStore(file), **decoding)


def _check(file: Any, maximum: int) -> None:
    """Refuse members that are no variables of the file itself, and too many bytes of values and texts."""
    total = 0
    for size in _sizes(file):
        total += size
        if total > maximum:
            raise UnreadableFile(f"unpacks to more than {maximum} bytes")


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
    """Return the names of the members of a group; links to other places are refused."""
    from h5py import h5l  # noqa: PLC0415 - needed for files only

    if root.get_num_objs() > MAX_VARIABLES:
        raise UnreadableFile(f"holds more than {MAX_VARIABLES} variables")
    kinds: dict[bytes, int] = {}
    root.links.iterate(lambda name, link: kinds.update({name: link.type}), info=True)
    if any(kind != h5l.TYPE_HARD for kind in kinds.values()):
        raise UnreadableFile("holds links to other places or files")
    return list(kinds)


def value_size(variable: Any, kind: Any) -> int:
    """Return the unpacked size of a variable's values; values outside the file itself are refused."""
    from h5py import h5d, h5z  # noqa: PLC0415 - needed for files only

    storage = variable.get_create_plist()
    layout = storage.get_layout()
    if layout not in (h5d.COMPACT, h5d.CONTIGUOUS, h5d.CHUNKED) or storage.get_external_count():
        raise UnreadableFile("has values that lie in other files")
    # [0]: the code of a filter
    filters = [storage.get_filter(index)[0] for index in range(storage.get_nfilters())]
    known = {h5z.FILTER_DEFLATE, h5z.FILTER_SHUFFLE, h5z.FILTER_FLETCHER32}
    # A repeated filter is refused too: deflate of deflate unpacks to a million times its size.
    if not known.issuperset(filters) or len(set(filters)) < len(filters):
        raise UnreadableFile("is packed in another way than by deflate, shuffle and fletcher32")
    if not _is_plain(kind):
        raise UnreadableFile("has values that are neither numbers nor texts")
    # A chunk is unpacked whole, also where it is larger than the variable.
    chunk = storage.get_chunk() if layout == h5d.CHUNKED else ()
    entries = max(math.prod(variable.get_space().get_simple_extent_dims()), math.prod(chunk))
    size: int = entries * kind.get_size()
    return size


def _attribute_sizes(owner: Any) -> Iterator[int]:
    """Yield the sizes of attributes; references to other files or to parts of variables are refused."""
    from h5py import h5a, h5t, string_dtype  # noqa: PLC0415 - needed for files only

    count = h5a.get_num_attrs(owner)
    if count > MAX_ATTRIBUTES:
        raise UnreadableFile(f"has more than {MAX_ATTRIBUTES} attributes in one place")
    for index in range(count):
        attribute = h5a.open(owner, index=index)
        kind, size = attribute.get_type(), attribute.get_storage_size()
        entries = size // kind.get_size()
        if not _is_plain(kind) and not all(part.equal(h5t.STD_REF_OBJ) for part in _parts(kind)):
            raise UnreadableFile("has attributes that are neither numbers, texts nor dimensions")
        if entries > MAX_ENTRIES and (_is_text(kind) or kind.get_class() == h5t.VLEN):
            raise UnreadableFile(f"has more than {MAX_ENTRIES} texts in an attribute")
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
    """Whether a type is of texts of variable length, which HDF5 stores outside the values themselves."""
    from h5py import h5t  # noqa: PLC0415 - needed for files only

    return bool(kind.get_class() == h5t.STRING and kind.is_variable_str())


def _parts(kind: Any) -> list[Any]:
    """Return the types of the entries of a list or a record, else the type itself.

    Integers of a record are left out: beside a reference they number the dimension that it stands for.
    """
    from h5py import h5t  # noqa: PLC0415 - needed for files only

    if isinstance(kind, h5t.TypeCompoundID):
        members = [kind.get_member_type(index) for index in range(kind.get_nmembers())]
        return [member for member in members if member.get_class() != h5t.INTEGER]
    return [kind.get_super()] if kind.get_class() == h5t.VLEN else [kind]
