"""A case as TOML, as a case file is written: no defaults left out, nothing that is not given."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from typing import Any


def toml_text(content: Mapping[str, Any]) -> str:
    """Return tables, numbers, texts, switches and (nested) lists of them as TOML; None is left out."""
    return "\n".join(_table(content, ())).strip() + "\n"


def _table(content: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[str]:
    """Write a table: its values first, then the tables in it."""
    given = {name: value for name, value in content.items() if value is not None}
    values = {name: value for name, value in given.items() if not isinstance(value, Mapping)}
    if path and (values or not given):
        yield f"\n[{'.'.join(path)}]"
    for name, value in values.items():
        yield f"{name} = {_value(value)}"
    for name, value in given.items():
        if isinstance(value, Mapping):
            yield from _table(value, (*path, name))


def _value(value: Any) -> str:
    """Write one value."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list | tuple):
        return f"[{', '.join(_value(item) for item in value)}]"
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError("a case holds finite numbers only")
    # texts are written as in JSON; integers and finite floats as Python does
    return json.dumps(value) if isinstance(value, str) else repr(value)
