"""Declared fields of the libraries from the boundary's fields."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from service.schemas.declared import figures


def in_si(kind: type[Any], given: BaseModel) -> dict[str, Any]:
    """Return the declared numbers and names of a dataclass, in SI, from the model that has them."""
    values = ((figure, getattr(given, figure.field)) for figure in figures(kind))
    return {
        figure.name: value * figure.unit.factor if isinstance(value, float) else value
        for figure, value in values
    }
