"""Stages of work, and the fraction of the whole that is done."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

from model_studies.progress import Progress, by_cost, silent, stage_name

_PACE_KNOWN = 0.1
"""Fraction of a stage from which on its pace alone predicts its time."""
_FIRST = 0.8
"""Share of the remaining work that a pass takes if another may follow: most passes are the last."""


class Stage(NamedTuple):
    """A stage of the work and its usual share of the time (the shares of a process sum to 1)."""

    name: str
    share: float


def staged(report: Progress) -> Callable[[float, str], None]:
    """Return the progress callback of `dynamics.simulation` that feeds ``report(stage, fraction)``."""
    return lambda fraction, _doing: report("integration", fraction)


class PacedFraction:
    """The fraction done of work whose cost nobody predicts, by the time that its stages take; it never falls.

    The usual shares say what stages take that have not begun, in proportion to the time so far. A stage under
    way takes what its pace says, that of the last one counts alone in the end. Stages that are left out, such
    as that of tables which are stored, have no share. `stages`: in the order in which they are done.
    """

    def __init__(self, stages: Iterable[tuple[str, float]]) -> None:
        self._shares = dict(stages)
        self._seen: list[str] = []
        self._begun_s = self._last_s = self._first_s = 0.0
        self._done = 0.0

    def at(self, stage: str, fraction: float, elapsed_s: float) -> float | None:
        """Return the fraction of the whole at a fraction of a stage, None for an undeclared stage.

        Parameters
        ----------
        fraction : float
            Completed fraction of the stage, 0 to 1.
        elapsed_s : float
            Seconds on a clock that never falls.
        """
        stage = stage_name(stage)
        if stage not in self._shares:
            return None
        if not self._seen:
            self._first_s = self._last_s = elapsed_s
        if stage not in self._seen:
            self._seen.append(stage)
            self._begun_s = self._last_s
        self._last_s = elapsed_s
        self._done = max(self._done, min(self._fraction(stage, fraction), 1.0))
        return self._done

    def _fraction(self, stage: str, fraction: float) -> float:
        """Return the time so far over the now expected time of the whole."""
        names = list(self._shares)
        share, ahead = self._shares[stage], sum(self._shares[n] for n in names[names.index(stage) + 1 :])
        before = sum(self._shares[name] for name in self._seen if name != stage)
        past_s, stage_s = self._begun_s - self._first_s, self._last_s - self._begun_s
        if past_s <= 0.0:
            return share * fraction / (share + ahead)
        usual_s = past_s * share / before
        known = min(fraction / _PACE_KNOWN, 1.0)
        total_s = (1.0 - known) * max(usual_s, stage_s) + (known * stage_s / fraction if fraction else 0.0)
        later_s = ahead * (past_s + total_s) / (before + share)
        return (past_s + stage_s) / (past_s + total_s + later_s)


class TableFraction:
    """The fraction done of a table, by the predicted cost of its stages; it never falls.

    A pass that begins anew takes what is left, or most of it if another may follow. `refines`: whether a pass
    may be followed by another, as under a tolerance.
    """

    def __init__(self, *, refines: bool = False) -> None:
        self._share = _FIRST if refines else 1.0
        self._done = 0.0
        self._progress: Progress = silent

    def plan(self, stages: Mapping[str, float]) -> None:
        """Take the predicted cost of the stages of a pass that begins."""
        done_before, share = self._done, self._share * (1.0 - self._done)
        self._progress = by_cost(lambda fraction: self._reach(done_before + share * fraction), stages)

    def at(self, stage: str, fraction: float) -> float:
        """Return the completed fraction of the table at a fraction of a stage."""
        self._progress(stage, fraction)
        return self._done

    def _reach(self, fraction: float) -> None:
        self._done = max(self._done, fraction)
