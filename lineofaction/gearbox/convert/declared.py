"""Dataclasses of the libraries from the tables of the boundary that have their fields."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import fields
from functools import cache
from typing import Any, TypeVar, cast

from pydantic import BaseModel

from bounds import inside
from lineofaction.gearbox.schemas.declared import figures, parts_of
from lineofaction.gearbox.schemas.faults import model_in
from lineofaction.gearbox.units import ENDINGS, factor

Part = TypeVar("Part")


def part_of(kind: type[Part], model: BaseModel | None, name: str, **further: Any) -> Part | None:
    """Return a dataclass of the libraries from the table that has its fields, None without a table.

    Raises `RefusedValue`: a value out of its bounds, named within `name`.
    """
    if model is None:
        return None
    with inside(name):
        return kind(**in_si(kind, model) | further)


def in_si(kind: type[Any], *models: BaseModel) -> dict[str, Any]:
    """Return the fields of a dataclass that tables have, in SI, each from the first that has it.

    A table has a field by its name alone, or by its name and unit: ``position`` or ``position_mm``. A table
    within a table is converted if the dataclass declares it as a part.

    Raises `RefusedValue`: a value of a part out of its bounds.
    """
    values: dict[str, Any] = {}
    for model in reversed(models):
        for name, field, unit in _shared_fields(cast("Hashable", kind), cast("Hashable", type(model))):
            values[name] = _in_unit(getattr(model, field), unit)
        for name, declaration in parts_of(kind).items():
            if declaration.part is not None and (value := getattr(model, name, None)) is not None:
                values[name] = _parts(declaration.part, value, name)
    return values


def _parts(kind: type[Part], value: BaseModel | tuple[BaseModel, ...], name: str) -> object:
    if isinstance(value, tuple):
        return tuple(part_of(kind, entry, f"{name}[{index}]") for index, entry in enumerate(value))
    return part_of(kind, value, name)


@cache
def _shared_fields(kind: Any, model: Any) -> tuple[tuple[str, str, float], ...]:
    """Return the fields that a dataclass and a table share: name, the table's name, SI value of its unit."""
    declared = {figure.name: (figure.field, figure.unit.factor) for figure in figures(kind)}
    plain = {name for name, field in model.model_fields.items() if model_in(field.annotation) is None}
    shared = []
    for name in (entry.name for entry in fields(kind) if entry.init):
        known = declared.get(name)
        fits = [known] if known else [(name + end, factor(name + end)) for end in ("", *ENDINGS)]
        shared += [(name, field, unit) for field, unit in fits if field in plain][:1]  # the first, if any
    return tuple(shared)


def _in_unit(value: Any, unit: float) -> Any:
    if unit == 1.0:
        return value
    if isinstance(value, tuple):
        return tuple(_in_unit(entry, unit) for entry in value)
    return value * unit if isinstance(value, float) else value
