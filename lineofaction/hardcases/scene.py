"""A hard scene: what makes it hard, what it must obey, and what was measured."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

TIME_LIMIT = 60.0
"""Seconds after which a scene is ended from outside, unless it says otherwise."""


@dataclass(frozen=True)
class Measured:
    """One figure of a scene, and the bounds that physics gives it; without bounds it only informs.

    Attributes
    ----------
    name : str
        What it is, with its unit unless it is a pure number.
    value : float
    most, least : float, optional
        The figure passes within them, both included.
    """

    name: str
    value: float
    most: float | None = None
    least: float | None = None

    @property
    def passed(self) -> bool:
        """Whether it is a number, and within its bounds."""
        low = -math.inf if self.least is None else self.least
        high = math.inf if self.most is None else self.most
        return math.isfinite(self.value) and low <= self.value <= high

    @property
    def bound(self) -> str:
        """The bounds in words; empty if there are none."""
        low = "" if self.least is None else f">= {self.least:.3g}"
        high = "" if self.most is None else f"<= {self.most:.3g}"
        return " and ".join(part for part in (low, high) if part)

    @property
    def use(self) -> float | None:
        """Part of its bound that a figure uses; None for a bound of zero or one met exactly (a count)."""
        if self.value in (self.most, self.least):
            return None
        uses = []
        if self.most is not None and self.most > 0.0 and self.value >= 0.0:
            uses.append(self.value / self.most)
        if self.least is not None and self.least > 0.0 and self.value > 0.0:
            uses.append(self.least / self.value)
        return max(uses) if uses else None

    def __str__(self) -> str:
        bound = self.bound
        return f"{self.name} {self.value:.3g}" + (f" ({bound})" if bound else "")


@dataclass(frozen=True)
class HardScene:
    """A scene that is known to be hard.

    Attributes
    ----------
    name, family : str
        Its name, and "contact", "table", "dynamics" or "service".
    hard_because, criterion : str
        What makes it hard; what must hold, from physics, in words.
    measure : callable
        Computes the scene and returns its figures; a function of a module, so that it can be sent to another
        process.
    time_limit : float
        Seconds.
    """

    name: str
    family: str
    hard_because: str
    criterion: str
    measure: Callable[[], Sequence[Measured]]
    time_limit: float = TIME_LIMIT

    def run(self) -> Outcome:
        """Compute the scene here; its exceptions come through (`guarded.run_scenes` catches them)."""
        begin, busy = time.perf_counter(), cpu_seconds()
        figures = tuple(self.measure())
        return Outcome(self, figures, time.perf_counter() - begin, cpu_seconds=cpu_seconds() - busy)


def cpu_seconds() -> float:
    """Return the CPU time of this process and of what it started and has ended, s."""
    return sum(os.times()[:4])


@dataclass(frozen=True)
class Outcome:
    """The outcome of a scene.

    Attributes
    ----------
    scene : HardScene
    figures : tuple of Measured
        Empty where it did not end.
    seconds : float
        Elapsed.
    ended_by : str
        What ended it before its time: an exception, a crash, the time limit; empty if nothing did.
    cpu_seconds : float
        CPU time, of the processes it started too; 0 where it did not end.
    """

    scene: HardScene
    figures: tuple[Measured, ...]
    seconds: float
    ended_by: str = ""
    cpu_seconds: float = 0.0

    @property
    def passed(self) -> bool:
        """Whether it ran to its end, measured something with a bound, and every figure is within its own."""
        bounded = any(figure.bound for figure in self.figures)
        return not self.ended_by and bounded and all(figure.passed for figure in self.figures)

    @property
    def failure(self) -> str:
        """The failure in words; empty if it passed."""
        if self.ended_by or self.passed:
            return self.ended_by
        return (
            "; ".join(str(figure) for figure in self.figures if not figure.passed) or "nothing was measured"
        )

    def to_json(self) -> dict[str, Any]:
        """Return plain JSON; a figure that is no number is None, and named in `failure`."""
        return {
            "name": self.scene.name,
            "family": self.scene.family,
            "hard_because": self.scene.hard_because,
            "criterion": self.scene.criterion,
            "passed": self.passed,
            "figures": {f.name: f.value if math.isfinite(f.value) else None for f in self.figures},
            "bounds": {f.name: f.bound for f in self.figures if f.bound},
            "seconds": self.seconds,
            "cpu_seconds": self.cpu_seconds,
            "failure": self.failure,
        }
