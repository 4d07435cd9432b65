"""Cases and scenes as TOML, as their files are written: nothing that is not given."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from typing import Any


def toml_text(content: Mapping[str, Any]) -> str:
    """Return tables, lists of them, numbers, texts, switches and (nested) lists as TOML; None is left out."""
    return "\n".join(_table(content, ())).strip() + "\n"


def _table(content: Mapping[str, Any], path: tuple[str, ...], head: str = "[{}]") -> Iterator[str]:
    """Write a table: its values first, then the tables in it."""
    present = {name: value for name, value in content.items() if value is not None}
    values = {name: value for name, value in present.items() if not _holds_tables(value)}
    if path and (values or not present or head != "[{}]"):
        yield f"\n{head.format('.'.join(path))}"
    for name, value in values.items():
        yield f"{name} = {_value(value)}"
    for name, value in present.items():
        if isinstance(value, Mapping):
            yield from _table(value, (*path, name))
        elif _holds_tables(value):
            for item in value:
                yield from _table(item, (*path, name), "[[{}]]")


def _holds_tables(value: Any) -> bool:
    return isinstance(value, Mapping) or (
        isinstance(value, list | tuple) and bool(value) and all(isinstance(item, Mapping) for item in value)
    )


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list | tuple):
        return f"[{', '.join(_value(item) for item in value)}]"
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError("these files hold finite numbers only")
    # texts are written as in JSON; integers and finite floats as Python does
    return json.dumps(value) if isinstance(value, str) else repr(value)
