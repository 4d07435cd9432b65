"""Predicted cost of a study before it begins, in CPU seconds and memory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from bounds import engineering
from lineofaction.gearbox.stages import LOADING

_SMALL = 0.02
"""Share of the total cost below which a part is not named."""
_UNPLANNED = 0.02
"""Largest share of a stage that a planned cost does not name."""
LONG = 3600.0
"""CPU seconds above which a cost is also written in hours, and a study adds a remedy to it."""

_PANELS = 6.0
"""Predicted CPU seconds of the panels (boundary elements) of one housing without panels in the cache. 5 to 60
were measured for gear cases, and 0.3 for a block."""


class Work(NamedTuple):
    """Pieces of the same work: their name in the plural, CPU seconds of each, and how many."""

    name: str
    piece_seconds: float
    pieces: float = 1.0
    stage: str = ""
    """Stage of the study whose progress this work reports; empty: of none."""

    @property
    def seconds(self) -> float:
        """CPU seconds of all pieces."""
        return self.piece_seconds * self.pieces

    @property
    def text(self) -> str:
        """Return the work as text: "24 values at 1.6 s", of a single piece "gears 3.2 s"."""
        piece_seconds = engineering(self.piece_seconds, 2)
        if self.pieces == 1.0:
            return f"{self.name} {piece_seconds} s"
        return f"{self.pieces:.0f} {self.name} at {piece_seconds} s"


@dataclass(frozen=True)
class StudyCost:
    """Predicted cost of a study."""

    parts: tuple[Work, ...]
    """The work, in its order."""
    bytes: float = 0.0
    """Largest memory at one time; 0: unknown."""
    remedy: str = ""
    """Reason of a high cost and a cheaper alternative, as sentences; empty for a usual cost."""

    @property
    def seconds(self) -> float:
        """CPU seconds of all parts."""
        return sum(part.seconds for part in self.parts)

    def shares(
        self, stages: Sequence[tuple[str, float]], loading_seconds: float = 0.0
    ) -> tuple[tuple[str, float], ...]:
        """Return names of stages with their shares of this cost; as they are if it names none of them.

        A stage that it does not name keeps its usual share, at most `_UNPLANNED`. `loading_seconds`: CPU
        seconds of loading within the first stage, as the share of `LOADING`.
        """
        planned = {name: sum(part.seconds for part in self.parts if part.stage == name) for name, _ in stages}
        total = sum(planned.values())
        if total <= 0.0:
            return tuple(stages)
        named = {part.stage for part in self.parts}
        shares = [
            (name, planned[name] / total if name in named else min(usual, _UNPLANNED))
            for name, usual in stages
        ]
        shares.insert(0, (LOADING, loading_seconds / total))
        whole = sum(share for _, share in shares)
        return tuple((name, share / whole) for name, share in shares)

    @property
    def text(self) -> str:
        """Return the cost as text: "about 40 CPU s, 1.2 GiB: gears 3.2 s, 24 values at 1.6 s"."""
        total = self.seconds
        memory = f", {engineering(self.bytes / 2**30, 2)} GiB" if self.bytes else ""
        parts = ", ".join(part.text for part in self._by_name if part.seconds > _SMALL * total)
        hours = f" ({engineering(total / 3600.0, 2)} h)" if total > LONG else ""
        remedy = f". {self.remedy}" if self.remedy else ""
        return f"about {engineering(total, 2)} CPU s{hours}{memory}: {parts}{remedy}"

    @property
    def _by_name(self) -> Iterator[Work]:
        """The parts; those of one name are one part, with the mean cost of a piece."""
        for name in dict.fromkeys(part.name for part in self.parts):
            parts = [part for part in self.parts if part.name == name]
            count = sum(part.pieces for part in parts)
            yield Work(name, sum(part.seconds for part in parts) / max(count, 1.0), count, parts[0].stage)

    def __add__(self, later: StudyCost) -> StudyCost:
        """Return the cost of this work and another after it."""
        remedy = " ".join(filter(None, (self.remedy, later.remedy)))
        return StudyCost((*self.parts, *later.parts), max(self.bytes, later.bytes), remedy)


def panels_work(housings: int) -> Work:
    """Return the usual work of making the panels of some housings."""
    return Work("panels", _PANELS, housings)
