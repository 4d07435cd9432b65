"""Cost of the contact by parts, and of a long cycle whose pitches are solved or follow from derivatives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from fe_contact.geometry import ParallelAxes

DRAWN = 16
"""Number of pitches that are drawn and solved. They measure the errors of derivatives in all others."""
BATCH = 8
"""Number of further pitches that are solved between two assessments of the errors."""
_FURTHER = 1
"""Batches that are expected beyond the first: 0 to 2 in tables of seven pairs of class 6, as counted."""
LONG_CYCLE = 64
"""Least number of base pitches for derivatives. In shorter cycles the drawn pitches would be too large a
part.
"""
TABLE_SAVES = 2.0
"""CPU seconds that derivatives save at least where a table takes them: a cheaper one is solved whole."""
_TANGENT = 0.4
"""CPU time of the tangents about a pitch over that of its solution."""
FLANKS = 9e-3
"""CPU seconds of the model of other flanks on the same compliance."""
_ADDED = 6e-9
"""CPU seconds to add the contribution of one tooth of one pair to one point."""


def solved_pitches(period: int, *, in_table: bool) -> tuple[int, int]:
    """Return how many pitches are solved where derivatives give the others: at least, and as expected.

    By the steps of `envelope.chosen`: those drawn, a batch, further ones until the errors are small enough.
    Of a table the first pitch, too, and a batch of those in which the pressure is largest.
    """
    fewest = DRAWN + BATCH + (1 + BATCH if in_table else 0)
    return min(fewest, period), min(fewest + _FURTHER * BATCH, period)


class ContactWork(NamedTuple):
    """CPU seconds to assemble a position, to solve one load at it, and of every pitch of a longer period.

    In each pitch the gaps of its teeth are found (`pitch`), and the first of a set of loads is solved from a
    guess (`begun` beside `point`). Where other flanks touch is looked for at every position (`touch`).
    """

    position: float
    point: float
    pitch: float
    begun: float
    touch: float

    def of(self, positions: float, points: float) -> float:
        """Return the CPU seconds of so many positions and points."""
        return positions * self.position + points * self.point

    def in_pitches(self, rows: float, sets: Sequence[float], pitches: float) -> float:
        """Return the CPU seconds of rows of positions in so many pitches, at sets of so many loads."""
        overhead = self.pitch + len(sets) * self.begun if pitches > 1 else 0.0
        return rows * pitches * (sum(sets) * self.point + overhead)

    def of_flanks(self, positions: float, loads: float) -> float:
        """Return the CPU seconds of other flanks at positions that are assembled, at so many loads each."""
        return FLANKS + positions * (self.touch + loads * self.point)


class CycleSeconds(NamedTuple):
    """CPU seconds that the contact of a cycle is predicted to take: all pitches solved, or by derivatives.

    The latter with the fewest pitches that are solved, by which it is decided, and as `expected`.
    """

    exact: float
    derivatives: float
    expected: float

    @classmethod
    def of(
        cls, work: ContactWork, pair: ParallelAxes, period: int, rows: float, sets: Sequence[float]
    ) -> CycleSeconds:
        """Predict them of rows of positions at sets of so many loads, of a table two, on condensed bodies."""
        teeth = 0.5 * (pair.pinion.teeth + pair.wheel.teeth) * rows * work.pitch
        meeting = 2 * (math.ceil(pair.transverse_contact_ratio + pair.overlap_ratio) + 1)

        def about(states: int) -> float:
            solved = (1.0 + _TANGENT) * work.in_pitches(rows, sets, states)
            return solved + teeth + _ADDED * meeting * states * period * rows * sum(sets)

        fewest, expected = solved_pitches(period, in_table=len(sets) > 1)
        return cls(work.in_pitches(rows, sets, period), about(1 + fewest), about(1 + expected))

    def pays(self, pitches: int) -> bool:
        """Whether derivatives are tried over a cycle of so many base pitches."""
        return pitches > LONG_CYCLE and self.derivatives < self.exact

    def pays_in_table(self, pitches: int) -> bool:
        """Whether they are in a table, which knows more of pitches that are solved."""
        return self.pays(pitches) and self.exact - self.derivatives > TABLE_SAVES
