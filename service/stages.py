"""Stages of work, and the fraction of the whole that is done."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from model_studies.progress import Progress, by_cost, silent


class Stage(NamedTuple):
    """A stage of the work and its share of the time (the shares of a process sum to 1)."""

    name: str
    share: float


def overall(stages: Iterable[tuple[str, float]], stage: str, fraction: float) -> float | None:
    """Return the fraction of the whole work, None for a stage that was not declared."""
    done = 0.0
    for name, share in stages:
        if name == stage:
            return min(1.0, done + share * fraction)
        done += share
    return None


_FIRST = 0.8
"""Share of what is left that a pass takes if another may follow: most passes are the last."""


class TableFraction:
    """The fraction done of a table, by the predicted cost of its stages; it never falls.

    A pass that begins anew takes what is left, or most of it if another may follow.

    Parameters
    ----------
    refines : bool
        Whether a pass may be followed by another, as under a tolerance.
    """

    def __init__(self, *, refines: bool = False) -> None:
        self._share = _FIRST if refines else 1.0
        self._done = 0.0
        self._progress: Progress = silent

    def plan(self, stages: Mapping[str, float]) -> None:
        """Take the predicted cost of the stages of a pass that begins."""
        begun, share = self._done, self._share * (1.0 - self._done)
        self._progress = by_cost(lambda fraction: self._reach(begun + share * fraction), stages)

    def at(self, stage: str, fraction: float) -> float:
        """Return the fraction of the table that is done when that of a stage is."""
        self._progress(stage, fraction)
        return self._done

    def _reach(self, fraction: float) -> None:
        """Note the fraction of the table."""
        self._done = max(self._done, fraction)
