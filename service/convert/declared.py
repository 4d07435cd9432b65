"""Declared fields of the libraries from the boundary's fields."""

from __future__ import annotations

from typing import Any, TypeVar

from pydantic import BaseModel

from bounds import inside
from service.schemas.declared import figures

Part = TypeVar("Part")


def declared_part(kind: type[Part], model: BaseModel | None, name: str, **further: Any) -> Part | None:
    """Return a part of the libraries' from the model that has its declared fields, None if it is left out.

    Raises
    ------
    RefusedValue
        A value out of its bounds, named within `name`.
    """
    if model is None:
        return None
    with inside(name):
        return kind(**in_si(kind, model), **further)


def in_si(kind: type[Any], model: BaseModel) -> dict[str, Any]:
    """Return the declared numbers and names of a dataclass, in SI, from the model that has them."""
    values = ((figure, getattr(model, figure.field)) for figure in figures(kind))
    return {
        figure.name: value * figure.unit.factor if isinstance(value, float) else value
        for figure, value in values
    }
