"""The hash of the inputs of a task, equal in every process that makes the same task."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum

import numpy as np

PROVENANCE_FIELDS = ("from_cache", "seconds")
"""Fields that record how a result was computed; they are no part of its content."""


def content_digest(content: object) -> str:
    """Return the SHA-256 of frozen data: dataclasses by their fields, arrays by type, shape and values.

    Raises `TypeError`: the content has an object of another kind, which has no rule of equality here.
    """
    digest = hashlib.sha256()
    for part in _parts(content):
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(part)
    return digest.hexdigest()


def _parts(content: object) -> list[bytes]:
    if content is None or isinstance(content, bool | int | float | str | bytes | np.generic):
        return [type(content).__name__.encode(), repr(content).encode()]
    if isinstance(content, np.ndarray):
        # the order counts: sums of equal arrays in other orders may round differently
        order = "C" if content.flags.c_contiguous else "F"
        kind = f"array {content.dtype.str} {content.shape} {order}"
        return [kind.encode(), np.ascontiguousarray(content).tobytes()]
    if isinstance(content, Enum):
        return [type(content).__qualname__.encode(), content.name.encode()]
    if isinstance(content, tuple | list):
        entries: list[object] = list(content)
    elif isinstance(content, Mapping):
        entries = list(content.items())
    elif is_dataclass(content):
        names = [field.name for field in fields(content) if field.name not in PROVENANCE_FIELDS]
        entries = [(name, getattr(content, name)) for name in names]
    else:
        raise TypeError(f"the content of {type(content).__name__} is not known")
    name = f"{type(content).__qualname__} {len(entries)}".encode()
    return [name, *(part for entry in entries for part in _parts(entry))]
