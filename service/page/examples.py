"""Cases that the page offers to begin with, as files of this package."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

_DIRECTORY = Path(__file__).parent / "examples"
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
"""The first is computed when the page opens with an empty address."""


@dataclass(frozen=True)
class Example:
    """A case to begin with.

    Attributes
    ----------
    name : str
        Of its file, without the ending.
    title, note : str
        What it is, for the list.
    content : dict
        As read from the file.
    """

    name: str
    title: str
    note: str
    content: dict[str, Any]


@lru_cache(maxsize=1)
def examples() -> tuple[Example, ...]:
    """Return the cases in the order in which they are offered."""
    return tuple(Example(*offered, tomllib.loads(_text(offered[0]))) for offered in _OFFERED)


def _text(name: str) -> str:
    return (_DIRECTORY / f"{name}.toml").read_text(encoding="utf-8")
