"""The spelling of a field of a study's inputs on the command line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, get_args, get_origin

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo


@dataclass(frozen=True)
class Spelling:
    """Spelling of a field as an option of the command line, as metadata beside the type of the field."""

    option: str
    value: str | None = None
    """Value that the option stands for; None: the option takes a value."""
    file: bool = False
    """Whether the option takes the file of a result, which the field names by its content hash."""


def spelling_of(field: FieldInfo) -> Spelling | None:
    """Return the spelling of a field, None if it is spelled as it is called."""
    return next((part for part in field.metadata if isinstance(part, Spelling)), None)


def item_type(field: FieldInfo) -> object:
    """Return the type of the items of a field's list, which may be absent; None: the field is no list."""
    for kind in map(_bare, (field.annotation, *get_args(field.annotation))):
        if get_origin(kind) is tuple:
            return _bare(get_args(kind)[0])
    return None


def _bare(kind: Any) -> Any:
    """Return a type without its metadata."""
    return kind.__origin__ if get_origin(kind) is Annotated else kind
