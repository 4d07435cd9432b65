"""Cases that the page offers to begin with."""

from __future__ import annotations

import tomllib
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

_EXAMPLES = Path(__file__).parent / "examples"
_OFFERED = (
    ("helical_ev_23_67", "EV reducer: helical 23/67, module 1.8 mm", "With relief and crowning."),
    ("industrial_spur_21_59", "Industrial gearbox: spur 21/59, module 5 mm", "With tip relief."),
    ("palermo_spur_20_20", "Spur 20/20, module 4 mm", "Published pair (ISMA 2010), in the plane."),
    (
        "helical_automotive",
        "Helical 39/40, module 3 mm",
        "Automotive pair (ISMA 2010) with relief and crowning.",
    ),
    ("internal_gear", "Planet 36 in ring 96, module 2 mm", "An internal pair in the plane."),
    (
        "pitch_error",
        "Spur with pitch deviations",
        "Every tooth of the pinion has its own place: 20 base pitches.",
    ),
)
"""The first is shown when the page opens with an empty address, with the result in `first.json`."""


class Example(NamedTuple):
    """A case to begin with: file name without the ending, description, and content."""

    name: str
    title: str
    note: str
    content: dict[str, Any]


@lru_cache(maxsize=1)
def examples() -> tuple[Example, ...]:
    """Return the cases in the order in which they are offered."""
    files = (_EXAMPLES / f"{name}.toml" for name, *_ in _OFFERED)
    tables = (tomllib.loads(file.read_text(encoding="utf-8")) for file in files)
    return tuple(Example(*offered, table) for offered, table in zip(_OFFERED, tables, strict=True))
