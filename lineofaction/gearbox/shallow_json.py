"""JSON of others, whose depth is bounded.

Python 3.14 reads JSON tens of thousands of levels deep; what looks at the tables next has no such stack.
"""

from __future__ import annotations

import json
from typing import Any

DEEPEST = 100
"""Levels of lists and tables in each other; the examples have up to 6."""


def shallow_json(text: str, **hooks: Any) -> Any:
    """Return the content of a JSON text; `hooks` are those of `json.loads`, and make no deeper tables.

    Raises `ValueError`: it is no JSON; `RecursionError`: it is deeper than `DEEPEST` levels.
    """
    content = json.loads(text, **hooks)
    level = [content]
    for _ in range(DEEPEST):
        level = [part for whole in level for part in _parts(whole)]
        if not level:
            return content
    raise RecursionError(f"more than {DEEPEST} levels")


def _parts(whole: Any) -> list[Any]:
    """Return the lists and tables in a list or table."""
    parts = whole.values() if isinstance(whole, dict) else whole if isinstance(whole, list) else ()
    return [part for part in parts if isinstance(part, dict | list)]
