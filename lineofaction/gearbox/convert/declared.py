"""Declared fields of the libraries from the boundary's fields."""

from __future__ import annotations

from typing import Any, TypeVar

from pydantic import BaseModel

from bounds import inside
from lineofaction.gearbox.schemas.declared import figures, parts_of

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


def in_si(kind: type[Any], *models: BaseModel) -> dict[str, Any]:
    """Return the declared fields of a dataclass, in SI, each from the first of the models that has it.

    Parts that are left out are left out.

    Raises
    ------
    RefusedValue
        A value of a part out of its bounds.
    """
    values = ((figure, _first(models, figure.field)) for figure in figures(kind))
    numbers = {
        figure.name: value * figure.unit.factor if isinstance(value, float) else value
        for figure, value in values
    }
    parts = {
        name: declared_part(fact.part, _first(models, name), name)
        for name, fact in parts_of(kind).items()
        if fact.part is not None
    }
    return numbers | {name: part for name, part in parts.items() if part is not None}


def _first(models: tuple[BaseModel, ...], field: str) -> Any:
    """Return a field of the first of the models that has it."""
    return next(getattr(model, field) for model in models if hasattr(model, field))
