"""The kind of a value that XML writes as text only."""

from __future__ import annotations

import functools
import tomllib
from collections.abc import Sequence
from importlib.resources import files

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Value
from lineofaction.gearbox.rexs.values import scalar_of, text_of

KINDS = (
    "floating_point",
    "integer",
    "boolean",
    "enum",
    "string",
    "reference_component",
    "file_reference",
    "date_time",
)
KIND_FIELD = "valueType"
"""Our field of XML's attributes, with the kind of a value whose text shows another; REXS allows it."""
_SHOWN = ("floating_point", "boolean")


def kind_of(attribute: str, texts: Sequence[str]) -> str:
    """Return the kind of the entries of an attribute's value.

    `kinds.toml` lists the attributes of REXS 1.0 to 2.0.0 whose kind their text does not show. Of
    others, and where the text is no value of the listed kind, a number is a floating point, true and false
    are boolean, and any other text is a string.
    """
    listed = _listed().get(attribute)
    if listed and _all_of(listed, texts):
        return listed
    return next((kind for kind in _SHOWN if _all_of(kind, texts)), "string")


def entry_kind(kind: str) -> str:
    """Return the kind of the entries of an array or a matrix, a scalar kind as it is."""
    for end in ("_arrays", "_array", "_matrix"):
        kind = kind.removesuffix(end)
    return kind.removeprefix("array_of_")


def texts_of(value: Value) -> list[str]:
    """Return the texts of all entries of a value, none of one that is not given."""
    if value is None:
        return []
    rows = value if isinstance(value, tuple) else (value,)
    return [text_of(entry) for row in rows for entry in (row if isinstance(row, tuple) else (row,))]


def _all_of(kind: str, texts: Sequence[str]) -> bool:
    """Return whether all texts are values of a kind; no text at all is a number not given."""
    try:
        for text in texts:
            scalar_of(kind, text, "")
    except BadInput:
        return False
    return True


@functools.cache
def _listed() -> dict[str, str]:
    """Return the kind by attribute."""
    table = tomllib.loads(files(__package__).joinpath("kinds.toml").read_text(encoding="utf-8"))
    return {attribute: kind for kind, attributes in table.items() for attribute in attributes}
