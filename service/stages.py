"""Stages of work and their shares of its time."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple


class Stage(NamedTuple):
    """A stage of the work and its share of the time (the shares of a process sum to 1)."""

    name: str
    share: float


TABLE_STAGES = (Stage("compliance", 0.6), Stage("contact", 0.15), Stage("error estimate", 0.25))
"""Of an STE database."""


def overall(stages: Iterable[tuple[str, float]], stage: str, fraction: float) -> float | None:
    """Return the fraction of the whole work, None for a stage that was not declared."""
    done = 0.0
    for name, share in stages:
        if name == stage:
            return min(1.0, done + share * fraction)
        done += share
    return None
