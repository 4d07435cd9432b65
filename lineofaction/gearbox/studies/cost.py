"""Predicted cost of a study before it begins, and the size of a scene whose tables are not computed yet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from bounds import engineering

if TYPE_CHECKING:
    pass

_SMALL = 0.02
"""Share of the whole below which a part is not named."""
LONG = 3600.0
"""CPU seconds from which on a cost is written in hours too, and with advice."""

_PANELS = 6.0
"""CPU seconds of the panels of a gear case, measured 5 to 60 for cases and 0.3 for a block; the cache keeps
the panels."""


class Work(NamedTuple):
    """Pieces of the same work: their name in the plural, CPU seconds of each, and how many."""

    name: str
    piece_seconds: float
    pieces: float = 1.0

    @property
    def seconds(self) -> float:
        """CPU seconds of all pieces."""
        return self.piece_seconds * self.pieces

    @property
    def text(self) -> str:
        """Return the work as text: "24 values at 1.6 s", of a single piece "gears 3.2 s"."""
        piece_seconds = engineering(self.piece_seconds, 2)
        return (
            f"{self.name} {piece_seconds} s"
            if self.pieces == 1.0
            else f"{self.pieces:.0f} {self.name} at {piece_seconds} s"
        )


@dataclass(frozen=True)
class StudyCost:
    """Predicted cost of a study: its parts in the order of the work, the largest memory if it is known.

    `remedy` says why it is as much, and what to try instead; empty of a cost that can be afforded.
    """

    parts: tuple[Work, ...]
    bytes: float = 0.0
    remedy: str = ""

    @property
    def seconds(self) -> float:
        """CPU seconds of all parts."""
        return sum(part.seconds for part in self.parts)

    @property
    def text(self) -> str:
        """Return the cost as text: "about 40 CPU s, 1.2 GiB: gears 3.2 s, 24 values at 1.6 s"."""
        total = self.seconds
        memory = f", {engineering(self.bytes / 2**30, 2)} GiB" if self.bytes else ""
        parts = ", ".join(part.text for part in self._by_name if part.seconds > _SMALL * total)
        hours = f" ({engineering(total / 3600.0, 2)} h)" if total > LONG else ""
        return (
            f"about {engineering(total, 2)} CPU s{hours}{memory}: {parts}{self.remedy and f'. {self.remedy}'}"
        )

    @property
    def _by_name(self) -> Iterator[Work]:
        """The parts, with parts of one name joined to one with their mean."""
        for name in dict.fromkeys(part.name for part in self.parts):
            same = [part for part in self.parts if part.name == name]
            count = sum(part.pieces for part in same)
            yield Work(name, sum(part.seconds for part in same) / max(count, 1.0), count)

    def __add__(self, later: StudyCost) -> StudyCost:
        """Return the cost of this work and another after it."""
        remedy = " ".join(filter(None, (self.remedy, later.remedy)))
        return StudyCost((*self.parts, *later.parts), max(self.bytes, later.bytes), remedy)


def panels_work(housings: int) -> Work:
    """Return the usual work of the panels of housings, whose meshes are not made before."""
    return Work("panels", _PANELS, housings)
