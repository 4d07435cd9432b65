"""Stages of work, and the fraction of the whole that is done."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from datetime import timedelta
from typing import NamedTuple

from model_studies.progress import Progress, stage_name

_PACE_KNOWN = 0.1
"""Fraction of a stage from which on its pace alone predicts its time."""
PACE_OF_WHOLE = 0.02
"""Fraction of the whole from which on what is left is told."""
LOADING = ""
"""Name of what loads within the first stage of a process, before its work: it is never reported."""


class Stage(NamedTuple):
    """A stage of the work and its usual share of the time (the shares of a process sum to 1)."""

    name: str
    share: float


def staged(report: Progress) -> Callable[[float, str], None]:
    """Return the progress callback of `dynamics.simulation` that feeds ``report(stage, fraction)``."""
    return lambda fraction, _doing: report("integration", fraction)


class PacedFraction:
    """The fraction done of work whose cost nobody predicts, by the time that its stages take; it never falls.

    The time of a stage that has not begun follows from the time so far and the usual shares. The time of the
    current stage follows from its pace; up to `_PACE_KNOWN`, its usual time counts as well. Stages that are
    left out, such as that of stored tables, count neither before nor after. `stages` are names with usual
    shares, in the order in which they are done; `LOADING` is in the first one that is reported.
    """

    def __init__(self, stages: Iterable[tuple[str, float]]) -> None:
        self._shares = dict(stages)
        self._loading = self._shares.pop(LOADING, 0.0)
        self._seen: list[str] = []
        self._first_s = 0.0  # times of the clock: the first report,
        self._begun_s = 0.0  # the end of the stage before the current one,
        self._last_s = 0.0  # the last report
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
            self._first_s = elapsed_s
            self._last_s = elapsed_s
        if stage not in self._seen:
            self._seen.append(stage)
            self._begun_s = self._last_s
        self._last_s = elapsed_s
        self._done = max(self._done, min(self._fraction(stage, fraction), 1.0))
        return self._done

    def _fraction(self, stage: str, fraction: float) -> float:
        """Return the time so far over the time now expected of the whole."""
        names = list(self._shares)
        share = self._shares[stage]
        ahead = sum(self._shares[name] for name in names[names.index(stage) + 1 :])
        before = sum(self._shares[name] for name in self._seen if name != stage)
        past_s = self._begun_s - self._first_s  # time of the stages before
        stage_s = self._last_s - self._begun_s  # time of the current stage so far
        if past_s <= 0.0:  # the first stage: the shares alone
            loaded = self._loading * min(fraction / _PACE_KNOWN, 1.0)
            return (loaded + share * fraction) / (self._loading + share + ahead)
        before += self._loading
        usual_s = past_s * share / before
        weight = min(fraction / _PACE_KNOWN, 1.0)  # of the time by the pace of the stage
        total_s = (1.0 - weight) * max(usual_s, stage_s) + (weight * stage_s / fraction if fraction else 0.0)
        later_s = ahead * (past_s + total_s) / (before + share)
        return (past_s + stage_s) / (past_s + total_s + later_s)


class TimeLeft:
    """The time that work still takes, as text: by its stages so far, or by the pace of one bar.

    `stages` as those of `PacedFraction`; empty: each stage alone. `begun_s`: time of the clock at the begin.
    """

    def __init__(self, stages: Iterable[tuple[str, float]], begun_s: float) -> None:
        known = tuple(stages)
        self._whole = PacedFraction(known) if known else None
        self._begun_s, self._stage_begun_s = begun_s, dict[str, float]()

    def text(self, stage: str, fraction: float, now_s: float) -> str:
        """Return "0:01:20 left" at a fraction of a stage; empty: not known yet, or nothing is left."""
        begun_s, done = self._begun_s, None
        if self._whole is not None:
            done = self._whole.at(stage, fraction, now_s)
        else:
            begun_s = self._stage_begun_s.setdefault(stage, now_s)
            done = fraction
        if done is None or not PACE_OF_WHOLE <= done < 1.0:
            return ""
        seconds = max((now_s - begun_s) * (1.0 - done) / done, 1.0)
        return f"{timedelta(seconds=round(seconds))} left"
