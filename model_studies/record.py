"""Records: dataclasses whose JSON follows from their fields; `record_file` has their files.

A field is called in JSON what it is called here, unless its metadata say otherwise::

    mean: FloatArray = field(metadata=in_unit("m"))  # "mean_m"
"""

from __future__ import annotations

import math
from dataclasses import Field, dataclass, fields
from typing import Any

import numpy as np

from bounds.types import Json


def in_unit(unit: str, *dimensions: str) -> dict[str, Any]:
    """Return the metadata of numbers in a unit, such as "m", which ends their name, along dimensions."""
    return {"unit": unit} | ({"dimensions": dimensions} if dimensions else {})


def called(key: str | None) -> dict[str, str | None]:
    """Return the metadata of a field that has another name in JSON; None: it is not written."""
    return {"key": key}


NOT_STORED = {"stored": False}
"""The metadata of a field that is in no file of the record; a default stands for it."""


@dataclass(frozen=True)
class Record:
    """Numbers, names, arrays and records; an unknown number is NaN and omitted from the JSON."""

    def to_json(self) -> Json:
        """Return plain JSON in SI units."""
        values = {_key(each): getattr(self, each.name) for each in fields(self)}
        return {key: _plain(value) for key, value in values.items() if key and _known(value)}


def _key(of: Field[Any]) -> str:
    """Return what a field is called in JSON; empty: it is not written."""
    if "unit" in of.metadata:
        return f"{of.name}_{of.metadata['unit']}"
    return of.metadata.get("key", of.name) or ""


def _known(value: object) -> bool:
    return not isinstance(value, float) or math.isfinite(value)


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, np.ndarray):
        return value.tolist()
    return value.to_json() if hasattr(value, "to_json") else value
