"""The structure of tuples by address: a key of all their content that code written out for them assumes."""

from __future__ import annotations

from collections.abc import Mapping
from ctypes import string_at
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

import llvmlite
import llvmlite.binding as llvm
import numpy as np

from dynamics.structure_code.arrays import LONGEST
from dynamics.structure_code.known_parts import Known
from dynamics.types import BoolArray, IntArray

MAX_AXES = 3  # most axes of an array


class _Layout(NamedTuple):
    """Layout of the words of a tuple: A arrays, I numbers."""

    address: IntArray
    """Word with the address of each array. Shape (A,)."""
    dimensions: IntArray
    """Words with the dimensions of each array; -1: the array has no such axis. Shape (A, 3)."""
    bytes: IntArray
    """Bytes of an item. Shape (A,)."""
    known: BoolArray
    """Whether each array holds integers that are part of a structure. Shape (A,)."""
    numbers: IntArray
    """Words with integers and flags. Shape (I,)."""


@cache
def _layout(kind: Any) -> _Layout:
    arrays, numbers = _slots(kind, 0)
    axes = [[first + 1 + k if k < array.ndim else -1 for k in range(MAX_AXES)] for first, array, _ in arrays]
    return _Layout(
        np.array([first for first, _, _ in arrays], dtype=np.int64),
        np.array(axes, dtype=np.int64).reshape(-1, MAX_AXES),
        np.array([getattr(array.dtype, "bitwidth", 8) // 8 for _, array, _ in arrays], dtype=np.int64),
        np.array([known for _, _, known in arrays], dtype=bool),
        np.array(numbers, dtype=np.int64),
    )


def _slots(kind: Any, origin: int) -> tuple[list[tuple[int, Any, bool]], list[int]]:
    """Return the arrays of a tuple whose words begin at `origin`, with their first word, and its integers."""
    arrays, numbers = [], []
    for name, field, first in kind.fields:
        if hasattr(field, "fields"):
            inner, more = _slots(field, origin + first)
            arrays += inner
            numbers += more
        elif hasattr(field, "ndim"):
            known = field.dtype.name != "float64" and name not in kind.numbers
            arrays.append((origin + first, field, known))
        elif field.name != "float64":
            numbers.append(origin + first)
    return arrays, numbers


@cache
def _of_sources() -> bytes:
    """Return a digest of all sources that code depends on, except the structure."""
    digest = sha256()
    for file in sorted(Path(__file__).parents[1].rglob("*.py")):
        digest.update(file.read_bytes())
    processor = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten(), llvm.get_process_triple()
    digest.update(repr((llvmlite.__version__, processor)).encode())
    return digest.digest()


def structure_key(tuples: Mapping[Any, Known]) -> str | None:
    """Return a key of the known part of `tuples`; None if arrays that are written overlap others.

    It holds the dimensions and items that are known, and which arrays are the same one.
    """
    digest, spans = sha256(_of_sources()), []
    for group, known in tuples.items():
        layout, slots = _layout(group._numba_type_), group._slots
        begin = slots[layout.address]
        lengths = np.append(slots, 1)[layout.dimensions]
        size = np.prod(lengths, axis=1)
        key_lengths = np.where(lengths <= LONGEST, lengths, -1)
        if known is Known.WIDTHS:
            key_lengths[:, 0] = -1
        digest.update(key_lengths.tobytes())
        if known is Known.ALL:
            digest.update(slots[layout.numbers].tobytes())
            for k in np.flatnonzero(layout.known & (size <= LONGEST) & (size > 0)):
                digest.update(string_at(int(begin[k]), int(size[k] * layout.bytes[k])))
        full = size > 0
        end = begin + size * layout.bytes
        spans.append(np.stack([begin, end, np.full(begin.size, known is not Known.ALL)])[:, full])
    begin, end, written = np.concatenate(spans, axis=1)
    _, first, same = np.unique(begin, return_index=True, return_inverse=True)
    digest.update(first[same].tobytes())
    order = np.lexsort((end, begin))
    return None if _overlap(begin[order], end[order], written[order]) else digest.hexdigest()[:40]


def _overlap(begin: IntArray, end: IntArray, written: IntArray) -> bool:
    """Return whether an array that is written overlaps one that begins elsewhere; sorted spans."""
    near = (begin[1:] < end[:-1]) & (begin[1:] != begin[:-1]) & ((written[1:] | written[:-1]) != 0)
    return bool(np.any(near))
