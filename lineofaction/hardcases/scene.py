"""Hard scenes: the reason why each is hard, its law, and its measured figures."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from host import cpu_seconds

TIME_LIMIT = 60.0
"""Seconds after which a scene is ended from outside, unless the scene states another limit."""

_M = TypeVar("_M", bound="Callable[[], Sequence[Measured]]")


@dataclass(frozen=True)
class Measured:
    """One figure of a scene, and the bounds that physics gives it; without bounds it only informs."""

    name: str
    """Name of the figure, with its unit unless it is a pure number."""
    value: float
    maximum: float | None = None
    minimum: float | None = None
    """`maximum`, `minimum`: Bounds within which the figure passes, both included."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", float(self.value))  # counts, answers and numbers of numpy too

    @property
    def passed(self) -> bool:
        """Whether it is a number, and within its bounds."""
        low = -math.inf if self.minimum is None else self.minimum
        high = math.inf if self.maximum is None else self.maximum
        return math.isfinite(self.value) and low <= self.value <= high

    @property
    def bound(self) -> str:
        """The bounds in words; empty if there are none."""
        low = "" if self.minimum is None else f">= {self.minimum:.3g}"
        high = "" if self.maximum is None else f"<= {self.maximum:.3g}"
        return " and ".join(part for part in (low, high) if part)

    @property
    def use(self) -> float | None:
        """Part of its bound that a figure uses; None for a bound of zero or one met exactly (a count)."""
        if self.value in (self.maximum, self.minimum):
            return None
        uses = []
        if self.maximum is not None and self.maximum > 0.0 and self.value >= 0.0:
            uses.append(self.value / self.maximum)
        if self.minimum is not None and self.minimum > 0.0 and self.value > 0.0:
            uses.append(self.minimum / self.value)
        return max(uses) if uses else None

    def __str__(self) -> str:
        bound = self.bound
        return f"{self.name} {self.value:.3g}" + (f" ({bound})" if bound else "")


@dataclass(frozen=True)
class HardScene:
    """A scene that is known to be hard."""

    name: str
    family: str
    """`name`, `family`: Name of the scene, and "contact", "table", "dynamics" or "service"."""
    hard_because: str
    criterion: str
    """`hard_because`, `criterion`: Reason why the scene is hard, and the physical law that must hold, in
    words."""
    measure: Callable[[], Sequence[Measured]]
    """Computes the scene and returns its figures; a function of a module, so that it can be sent to another
    process.
    """
    time_limit: float = TIME_LIMIT
    """Seconds."""

    def run(self) -> Outcome:
        """Compute the scene here; its exceptions come through (`run_scenes` catches them)."""
        begin, busy = time.perf_counter(), cpu_seconds()
        figures = tuple(self.measure())
        return Outcome(self, figures, time.perf_counter() - begin, cpu_seconds=cpu_seconds() - busy)


@dataclass(frozen=True)
class Scenes:
    """Scenes of one family, in the order in which their file declares them."""

    family: str
    listed: list[HardScene] = field(default_factory=list)

    def add(self, name: str, hard_because: str, criterion: str) -> Callable[[_M], _M]:
        """Return the decorator that makes a scene of the function that measures it."""

        def declare(measure: _M) -> _M:
            self.listed.append(HardScene(name, self.family, hard_because, criterion, measure))
            return measure

        return declare


@dataclass(frozen=True)
class Outcome:
    """The outcome of a scene."""

    scene: HardScene
    figures: tuple[Measured, ...]
    """Figures of the scene; empty if the scene was ended early."""
    seconds: float
    """Elapsed time in seconds."""
    ended_by: str = ""
    """Cause of an early end: an exception, a crash, the time limit; empty: the scene ran to its end."""
    cpu_seconds: float = 0.0
    """CPU time including the processes that the scene started; 0 after an early end."""

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


def largest(values: NDArray[np.float64]) -> float:
    """Return the largest size of the values."""
    return float(np.abs(values).max())
