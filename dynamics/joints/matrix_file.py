"""Matrices from files: rows of numbers in CSV, arrays in a NumPy archive, which holds no objects."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np

from dynamics.errors import InputError
from dynamics.types import FloatArray

_HEADERS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
LARGEST = 2**27
"""Bytes of a CSV file, or of an archive unpacked: three matrices of 2300 rows."""


def read_csv(file: Path, field: str) -> FloatArray:
    """Return the rows of a CSV file, ``#`` before remarks; raises as `read_archive`."""
    _check_size(file.stat().st_size, file, field)
    try:
        with file.open(encoding="utf-8") as stream:
            return np.asarray(np.loadtxt(stream, delimiter=",", comments="#", ndmin=2))
    except (ValueError, OSError) as error:
        bound = "rows of as many numbers, with commas between"
        raise InputError(field, file.name, bound, "Begin remarks with #.") from error


def read_archive(file: Path, field: str) -> dict[str, FloatArray]:
    """Return the arrays of an archive by their names.

    Parameters
    ----------
    file : Path
        A file of `numpy.savez`.
    field : str
        What names it, for errors.

    Raises
    ------
    InputError
        It is none, is too large unpacked, or holds something else than numbers.
    """
    try:
        with ZipFile(file) as archive:
            members = archive.infolist()
            _check_size(sum(member.file_size for member in members), file, field)
            return {member.filename.removesuffix(".npy"): _array(archive, member) for member in members}
    except InputError:
        raise
    # what zipfile, its decompressors and numpy raise on foreign bytes is not one class
    except Exception as error:
        bound = "a NumPy archive of arrays of numbers"
        raise InputError(field, file.name, bound, "Write it by numpy.savez, without objects.") from error


def _array(archive: ZipFile, member: Any) -> FloatArray:
    """Return an array of numbers, as large as its member: `numpy.load` makes room for what a header says."""
    with archive.open(member) as stream:
        shape, by_columns, kind = _HEADERS[np.lib.format.read_magic(stream)](stream)
        if kind.kind not in "iuf" or math.prod(shape) * kind.itemsize != member.file_size - stream.tell():
            raise ValueError(kind, shape)
        values = np.frombuffer(stream.read(), kind)
    return values.astype(float).reshape(shape, order="F" if by_columns else "C")


def _check_size(size: int, file: Path, field: str) -> None:
    """Refuse more bytes than matrices have."""
    if size > LARGEST:
        raise InputError(field, file.name, f"of at most {LARGEST} bytes", "Reduce it to fewer coordinates.")
