"""Estimated against measured changes: criterion of a right estimate, share of right ones, and tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.figures import Figure

FLOOR = 0.01
"""Relative change below which both count as nothing: the usual tolerance, and the error of a draft."""
FACTOR, SHARE = 2.0, 80.0


def within_factor(estimated: float, measured: float, floor: float = FLOOR) -> bool:
    """Whether two changes agree in sign and within a factor two, or are both nothing."""
    if max(abs(estimated), abs(measured)) < floor:
        return True
    return estimated * measured > 0.0 and 1.0 / FACTOR <= abs(estimated / measured) <= FACTOR


@dataclass(frozen=True)
class AssessedEffect:
    """One effect of one case or scene: relative changes by leaving it out, per quantity of the study.

    `off_at` are the tolerances at which "auto" leaves it off.
    """

    where: str
    effect: str
    estimated: tuple[float, ...]
    measured: tuple[float, ...]
    off_at: tuple[float, ...] = ()

    @property
    def right(self) -> tuple[bool, ...]:
        """Whether each quantity is within a factor two."""
        pairs = zip(self.estimated, self.measured, strict=True)
        return tuple(within_factor(estimated, measured) for estimated, measured in pairs)

    @property
    def decided_by(self) -> float:
        """Largest measured change of the quantities by which "auto" decides."""
        return max(map(abs, self.measured))

    @property
    def cells(self) -> str:
        """Columns of a row: estimated / measured change in %, bold where the estimate is not right."""
        cells = []
        for estimated, measured, right in zip(self.estimated, self.measured, self.right, strict=True):
            text = f"{100.0 * estimated:+.2g} / {100.0 * measured:+.2g}"
            cells.append(text if right else f"**{text}**")
        return " | ".join(cells)


def per_cent_right(found: Sequence[AssessedEffect], quantity: int | None = None) -> float:
    """Return the percentage of right estimates, in one quantity or in all of them at once."""
    right = [all(one.right) if quantity is None else one.right[quantity] for one in found]
    return 100.0 * float(np.mean(right)) if right else 100.0


@dataclass(frozen=True)
class InfluenceStudy:
    """Subject, quantities and limits of a study, and its words for them."""

    subject: str
    one: str
    anywhere: str
    """`subject`, `one`, `anywhere`: Subject of its figures, object of an ablation, and place where an
    estimate may be wrong, in words.
    """
    quantities: tuple[str, ...]
    tolerances: tuple[float, ...]
    """Tolerances at which the decisions of "auto" are assessed."""

    def counts(self, found: Sequence[AssessedEffect]) -> list[Figure]:
        """Return how often the estimates are right."""
        wrong = 100.0 - per_cent_right(found)
        return [
            Figure(self.subject, f"ablations ({self.one})", float(len(found)), "-"),
            Figure(self.subject, f"{self.anywhere} beyond a factor {FACTOR:g}", wrong, "%", 100.0 - SHARE),
            *self.by_quantity(found),
        ]

    def by_quantity(self, found: Sequence[AssessedEffect]) -> list[Figure]:
        """Return how often each quantity is wrong where it can be seen, and what "auto" neglects."""
        rows = []
        for k, name in enumerate(self.quantities):
            visible = [one for one in found if max(abs(one.estimated[k]), abs(one.measured[k])) >= FLOOR]
            changes = f"{len(visible)} changes above {100 * FLOOR:g} %"
            what = f"{name}: beyond a factor {FACTOR:g}, of the {changes}"
            rows.append(Figure(self.subject, what, 100.0 - per_cent_right(visible, k), "%", 100.0 - SHARE))
        return rows + [self._left_off(found, tolerance) for tolerance in self.tolerances]

    def _left_off(self, found: Sequence[AssessedEffect], tolerance: float) -> Figure:
        """Return the largest change of any quantity by an effect that "auto" neglects."""
        off = [one for one in found if tolerance in one.off_at]
        worst = max((one.decided_by for one in off), default=0.0)
        what = f"largest change by what auto neglects at {100 * tolerance:g} % ({len(off)} ablations)"
        return Figure(self.subject, what, 100.0 * worst, "%", 100.0 * tolerance)


def by_effect(found: Sequence[AssessedEffect]) -> dict[str, list[AssessedEffect]]:
    """Return the ablations of every effect, in the order they were found."""
    names = dict.fromkeys(one.effect for one in found)
    return {name: [one for one in found if one.effect == name] for name in names}
