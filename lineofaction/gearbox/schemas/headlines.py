"""Summary of a case or a scene in a dozen lines."""

from __future__ import annotations

from typing import TypeVar

from pydantic import BaseModel

from bounds.brief import Row, described_value, html_of, text_of

Model = TypeVar("Model", bound=BaseModel)


def in_brief(kind: type[Model]) -> type[Model]:
    """Give a model the short text and HTML of its tables; a decorator."""
    kind.headlines = headlines  # type: ignore[attr-defined]
    kind.__repr__ = kind.__str__ = text_of  # type: ignore[method-assign]
    kind._repr_html_ = html_of  # type: ignore[attr-defined]
    return kind


def headlines(model: BaseModel) -> tuple[str, list[Row]]:
    """Return the name of a model and a row for each table or value that it states."""
    return type(model).__name__.removesuffix("Input"), [
        (name, _text(value)) for name, value in _fields(model)
    ]


def _fields(model: BaseModel) -> list[tuple[str, object]]:
    return [
        (name, getattr(model, name)) for name in type(model).model_fields if name in model.model_fields_set
    ]


def _text(value: object) -> str:
    """Return a table by the values that it states, parts by their names or number."""
    if isinstance(value, BaseModel):
        parts = sorted(_fields(value), key=lambda entry: not isinstance(entry[1], BaseModel))  # gears first
        return ", ".join(f"{name} {_short(part)}" for name, part in parts)
    if isinstance(value, list | tuple) and value and isinstance(value[0], BaseModel):
        return described_value([str(getattr(part, "name", type(part).__name__)) for part in value])
    return described_value(value)


def _short(part: object) -> str:
    if isinstance(part, BaseModel):
        teeth = getattr(part, "teeth", None)
        return f"z {teeth}" if teeth is not None else "..."
    return described_value(part)
