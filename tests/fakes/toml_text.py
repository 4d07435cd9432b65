"""Tables as text of a TOML file."""

import json
from typing import Any


def toml_text(table: dict[str, Any]) -> str:
    return "".join(f"{key} = {_inline(value)}\n" for key, value in table.items())


def _inline(value: Any) -> str:
    """One TOML value; nan and inf are TOML, and no JSON."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_inline(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_inline(item) for item in value) + "]"
    return str(value) if isinstance(value, float) else json.dumps(value)
