"""Declared fields of the libraries from the boundary's fields."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import BaseModel

from bounds import Declared, inside
from service.schemas.declared import figures, parts_of

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
    """Return the declared fields of a dataclass, in SI, from the model that has them.

    Parts that are left out are left out.

    Raises
    ------
    RefusedValue
        A value of a part out of its bounds.
    """
    values = ((figure, getattr(model, figure.field)) for figure in figures(kind))
    numbers = {
        figure.name: value * figure.unit.factor if isinstance(value, float) else value
        for figure, value in values
    }
    return numbers | parts_in_si(parts_of(kind), model)


def parts_in_si(parts: Mapping[str, Declared], model: BaseModel) -> dict[str, Any]:
    """Return the parts that a model has by name; raises as `in_si`."""
    own = {
        name: declared_part(fact.part, getattr(model, name), name)
        for name, fact in parts.items()
        if fact.part is not None
    }
    return {name: part for name, part in own.items() if part is not None}
