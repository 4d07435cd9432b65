"""Metadata of the fields of dataclasses, by which `record_file` writes them."""

from __future__ import annotations

from dataclasses import Field
from typing import Any

NOT_STORED = {"stored": False}
"""The metadata of a field that is in no file of the record; a default stands for it."""


def under_key(key: str) -> dict[str, Any]:
    """Return the metadata of a field that files hold by another name than that of the attribute."""
    return {"key": key}


def key_of(field: Field[Any]) -> str:
    """Return the name by which a file holds a field."""
    return str(field.metadata.get("key", field.name))


def in_unit(unit: str, *dimensions: str) -> dict[str, Any]:
    """Return the metadata of numbers in a unit, such as "m", which ends their name, along dimensions."""
    return {"unit": unit} | ({"dimensions": dimensions} if dimensions else {})
