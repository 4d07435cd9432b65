"""The words of a plot, which hold the names that callers chose: written so that what draws them shows them.

Libraries of plots take some characters for markup, each its own. A description is plain text; it is rewritten
whole before it is drawn, so that no text is forgotten.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from typing import Any, TypeVar, cast

Description = TypeVar("Description")


def rewritten(description: Description, write: Callable[[str], str]) -> Description:
    """Return a description with all its texts rewritten; colors and the like hold nothing to rewrite."""
    return cast(Description, _rewritten(description, write))


def _rewritten(part: Any, write: Callable[[str], str]) -> Any:
    """Rewrite a text, the entries of a tuple, or the fields of a record; leave numbers alone."""
    if isinstance(part, str):
        return write(part)
    if isinstance(part, tuple):
        return tuple(_rewritten(entry, write) for entry in part)
    if is_dataclass(part) and not isinstance(part, type):
        return replace(
            part, **{each.name: _rewritten(getattr(part, each.name), write) for each in fields(part)}
        )
    return part
