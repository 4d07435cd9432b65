"""Documents of results beside the models that declare them."""

import json
from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel

from lineofaction.gearbox.registry import figures_model
from lineofaction.gearbox.schemas.figures import Figures

_OF_FILE = {"hash": "", "sha256": "", "size": 0}


def document(figures: Figures) -> dict[str, Any]:
    return figures.model_dump(mode="json", by_alias=True, exclude_unset=True)


def check_declared(kind: str, answer: Mapping[str, Any]) -> None:
    said_by_verbs = ("written", "file")
    told = _OF_FILE | {name: value for name, value in answer.items() if name not in said_by_verbs}
    figures = figures_model(kind).model_validate_json(json.dumps(told))
    assert type(figures) is not Figures
    assert document(figures) == told
    assert list(undeclared(figures)) == []


def undeclared(part: Any, at: str = "") -> Iterator[str]:
    """Yield the members of figures, and of their parts, that no model declares."""
    if isinstance(part, BaseModel):
        yield from (f"{at}.{name}" for name in part.model_extra or ())
        for name in type(part).model_fields:
            yield from undeclared(getattr(part, name), f"{at}.{name}")
    elif isinstance(part, list | tuple):
        for entry in part:
            yield from undeclared(entry, f"{at}[]")
    elif isinstance(part, dict):
        for name, entry in part.items():
            yield from undeclared(entry, f"{at}.{name}")
