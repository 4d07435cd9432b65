"""A key of a scene's content: effects have the same sizes in all scenes with the same key."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from fractions import Fraction
from hashlib import sha256
from pathlib import PurePath
from typing import Any

import numpy as np

from dynamics.scene import Scene

UNREAD = frozenset(("integration", "on_violation", "level_tolerance", "outputs"))
"""Fields of a scene that no size of an effect depends on, except for the sampling of the outputs."""
_PLAIN = (str, bytes, int, float, complex, bool, type(None), Enum, Fraction, PurePath)


def content_key(scene: Scene) -> bytes | None:
    """Return the SHA-256 of all that sizes of effects depend on; None where a part is no plain data.

    A quantity of a user's own class may be no dataclass: its content is not known.
    """
    digest = sha256()
    read = {name: part for name, part in vars(scene).items() if name not in UNREAD}
    sampling = (scene.outputs.sample_rate, scene.outputs.mesh_orders, scene.outputs.band)
    try:
        _feed(digest, (read, sampling))
    except TypeError:
        return None
    return digest.digest()


def _feed(digest: Any, value: object) -> None:
    """Add a value with its type, so that no two contents give the same bytes; `TypeError`: not plain."""
    digest.update(f"{type(value).__module__}.{type(value).__qualname__}:".encode())
    if isinstance(value, _PLAIN):
        text = repr(value).encode()
        digest.update(b"%d:" % len(text) + text)
    elif isinstance(value, np.ndarray | np.generic):
        _feed_array(digest, np.asarray(value))
    elif isinstance(value, Mapping):
        digest.update(b"%d:" % len(value))
        for name in sorted(value, key=repr):
            _feed(digest, name)
            _feed(digest, value[name])
    elif isinstance(value, tuple | list):
        _feed_sequence(digest, value)
    elif is_dataclass(value):
        for part in fields(value):
            digest.update(part.name.encode() + b"=")
            _feed(digest, getattr(value, part.name))
    else:
        raise TypeError(f"no plain data: {type(value)}")


def _feed_array(digest: Any, array: np.ndarray[Any, Any]) -> None:
    if array.dtype.hasobject:
        raise TypeError("an array of objects")
    digest.update(f"{array.dtype.str}{array.shape}:".encode())
    digest.update(np.ascontiguousarray(array).data)


def _feed_sequence(digest: Any, value: tuple[object, ...] | list[object]) -> None:
    """Add the parts one by one; matrices as rows of numbers at once."""
    digest.update(b"%d:" % len(value))
    if value and isinstance(value[0], tuple) and all(_is_row(row) for row in value):
        lengths = np.array([len(row) for row in value if isinstance(row, tuple)])
        _feed_array(digest, lengths)
        _feed_array(digest, np.array([number for row in value if isinstance(row, tuple) for number in row]))
        return
    for part in value:
        _feed(digest, part)


def _is_row(row: object) -> bool:
    return isinstance(row, tuple) and set(map(type, row)) == {float}
