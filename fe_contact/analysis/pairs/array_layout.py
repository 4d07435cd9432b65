"""Layout of arrays in memory: parts of a whole laid out as the rows that they are."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any, TypeVar

import numpy as np

Arrays = TypeVar("Arrays", bound=Any)


def laid_out_alike(part: Arrays, template: Arrays) -> Arrays:
    """Return a dataclass of arrays and of such, its arrays in memory as those they are rows of.

    Compiled sums along a row round otherwise where its numbers stand apart.
    """
    alike: Arrays = replace(
        part,
        **{
            field.name: _alike(getattr(part, field.name), getattr(template, field.name))
            for field in fields(part)
        },
    )
    return alike


def _alike(part: Any, template: Any) -> Any:
    """Lay out one value as another."""
    if is_dataclass(part):
        return laid_out_alike(part, template)
    if not isinstance(part, np.ndarray):
        return part
    return np.ascontiguousarray(part) if template.flags.c_contiguous else np.asfortranarray(part)
