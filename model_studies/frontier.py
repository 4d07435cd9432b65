"""Error against time of the fidelities of a model: the results, their front and its knee."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Generic, TypeVar

import numpy as np

from bounds.types import Json
from model_studies.record import Record, called

# The front of error against time, and its knee.


def front_of(points: Mapping[str, tuple[float, float]]) -> tuple[str, ...]:
    """Return the names of the Pareto-optimal points (time, error), the fastest first."""
    best = float("inf")
    front = []
    for name in sorted(points, key=lambda key: points[key]):
        if points[name][1] < best:
            best = points[name][1]
            front.append(name)
    return tuple(front)


def knee_of(points: Mapping[str, tuple[float, float]]) -> str | None:
    """Return the point after which time buys least: the deepest below the line between the ends, log-log.

    The curve is the front, and from its last point on level to the slowest point. None with fewer than three
    points, or if it nowhere bends below the line.
    """
    front = front_of(points)
    if len(points) < 3 or any(value <= 0.0 for point in points.values() for value in point):
        return None
    corners = [points[name] for name in front]
    slowest = max(time for time, _ in points.values())
    time, error = np.log(np.array([*corners, (slowest, corners[-1][1])])).T
    if time[-1] <= time[0] or error[0] <= error[-1]:
        return None
    x, y = (time - time[0]) / (time[-1] - time[0]), (error[0] - error) / (error[0] - error[-1])
    below = (y - x)[: len(front)]
    deepest = int(np.argmax(below))
    return front[deepest] if below[deepest] > 1e-12 else None


@dataclass(frozen=True)
class FidelityResult(Record):
    """The outcome of one fidelity; a library adds its errors and further figures.

    Attributes
    ----------
    FIGURES : tuple of str
        The fields that are relative errors; NaN: not known.
    name, title : str
    cpu_seconds : float
        Of the whole computation.
    """

    FIGURES: ClassVar[tuple[str, ...]]

    name: str
    title: str
    cpu_seconds: float

    @property
    def errors(self) -> dict[str, float]:
        """The errors that are known, by figure."""
        errors = {name: getattr(self, name) for name in self.FIGURES}
        return {name: error for name, error in errors.items() if np.isfinite(error)}

    @property
    def error(self) -> float:
        """The largest known error, which a tolerance limits; NaN without any."""
        return max(self.errors.values(), default=float("nan"))


R_co = TypeVar("R_co", bound=FidelityResult, covariant=True)


@dataclass(frozen=True)
class Frontier(Record, Generic[R_co]):
    """An accuracy study.

    Attributes
    ----------
    results : tuple of FidelityResult
        In the order of their usual cost; the last one is the reference, whose errors are its own.
    left_out : dict
        Name of a fidelity to the reason why it has no result.
    knee : str or None
        The fidelity after which time buys least, by the largest error; None with fewer than three fidelities,
        or if the front does not bend.
    chosen : str or None
        The fidelity of the request.
    """

    results: tuple[R_co, ...] = field(metadata=called("rungs"))
    left_out: dict[str, str]
    knee: str | None
    chosen: str | None

    @property
    def reference(self) -> R_co:
        """The finest fidelity that was run."""
        return self.results[-1]

    def to_json(self) -> Json:
        """Return plain JSON in SI units."""
        return {**super().to_json(), "reference": self.reference.name}


def knee_above(results: Sequence[FidelityResult], *shared: float) -> str | None:
    """Return the knee; differences below the reference's own error, or below `shared` errors, are ignored."""
    own = [error for error in (results[-1].error, *shared) if np.isfinite(error)]
    floor = max(own, default=0.0)
    known = [result for result in results if np.isfinite(result.error)]
    return knee_of({result.name: (result.cpu_seconds, max(result.error, floor)) for result in known})
