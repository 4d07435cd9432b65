"""Parts of tuples that belong to the structure of a run, which code is written out for."""

from __future__ import annotations

from enum import Enum


class Known(Enum):
    """Part of a tuple that belongs to the structure of a run."""

    ALL = "integers and dimensions"
    DIMENSIONS = "all dimensions"
    WIDTHS = "dimensions but the first"
