"""Fidelities of a model, how they vary, and the frontier of error over cost."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Generic, Protocol, TypeVar

import numpy as np

from bounds.brief import brief
from host import cpu_seconds
from model_studies.progress import Progress
from model_studies.record import under_key
from model_studies.result_record import ResultRecord
from model_studies.variants import run_variants

R = TypeVar("R")  # result
Q = TypeVar("Q")  # request
Q_contra = TypeVar("Q_contra", contravariant=True)
Errors = Mapping[str, float]
"""Relative errors by the name of the figure; NaN: not known."""


class Fidelity(Protocol[Q_contra]):
    """A model or setting, coarse or fine, that computes a request."""

    @property
    def name(self) -> str:
        """Key in tables and JSON."""

    @property
    def title(self) -> str:
        """Name of the fidelity in words."""

    @property
    def family(self) -> str:
        """Parameter that varies within a family: errors fall towards its finest value."""

    def refusal(self, request: Q_contra) -> str | None:
        """Return why this fidelity is not valid for a request; None if it is."""


F = TypeVar("F", bound=Fidelity[Any])


@dataclass(frozen=True)
class Outcome(Generic[F, R]):
    """The result of a fidelity, and its CPU time, s."""

    fidelity: F
    result: R
    cpu_seconds: float


def run_fidelities(
    fidelities: Sequence[F],
    request: Q,
    warm_up: Callable[[Sequence[F]], None],
    compute: Callable[[F], R],
    failures: tuple[type[Exception], ...],
    progress: Progress,
    costs: Mapping[str, float] | None = None,
) -> tuple[list[Outcome[F, R]], dict[str, str]]:
    """Run every fidelity that is valid for a request, one after the other, so that their times compare.

    Parameters
    ----------
    fidelities : sequence of Fidelity
        Fidelities in the order of their usual cost.
    warm_up : callable
        Function that loads and compiles the code of these fidelities, so that their times do not include it.
    compute : callable
        Function that runs one fidelity.
    failures : tuple of exception types
        Exceptions for which a fidelity is omitted. The last of these types is raised where fewer than two
        results are left.

    costs : mapping, optional
        Predicted cost of fidelities, see `run_variants`.

    Returns
    -------
    outcomes, omitted
        Outcomes in the order of the fidelities, and the reasons why others have none, by name.
    """
    refusals = {fidelity.name: fidelity.refusal(request) for fidelity in fidelities}
    refused = {name: reason for name, reason in refusals.items() if reason is not None}
    valid = [fidelity for fidelity in fidelities if fidelity.name not in refused]
    warm_up(valid)

    def timed(fidelity: F) -> Outcome[F, R]:
        start = cpu_seconds()
        result = compute(fidelity)
        return Outcome(fidelity, result, cpu_seconds() - start)

    by_name = {fidelity.name: fidelity for fidelity in valid}
    outcomes, failed = run_variants("ladder", by_name, timed, failures, progress, costs=costs)
    omitted = refused | failed
    if len(outcomes) < 2:
        raise failures[-1](f"an error needs two fidelities to compare; left out: {omitted}")
    return list(outcomes.values()), omitted


def against_finest(
    outcomes: Sequence[Outcome[F, R]],
    errors: Callable[[R, R], Errors],
    remaining: Callable[[Sequence[tuple[F, Errors]], F], Errors],
) -> list[Errors]:
    """Return the errors of every outcome against the last one, and the remaining errors of that one.

    `errors` compares a result with the reference; `remaining` estimates the errors of the finest fidelity
    from those of the coarser fidelities of its family.
    """
    *coarser, finest = outcomes
    measured = [errors(outcome.result, finest.result) for outcome in coarser]
    family = [
        (outcome.fidelity, error)
        for outcome, error in zip(coarser, measured, strict=True)
        if outcome.fidelity.family == finest.fidelity.family
    ]
    return [*measured, remaining(family, finest.fidelity)]


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
    """Return the point of the front after which more time lowers the error least.

    It is the point deepest below the straight line from the first to the last point of a curve, error over
    time in logarithmic scales. The curve is the Pareto front, continued from its last point at the same error
    to the time of the slowest point. None with fewer than three points, or where the curve does not bend
    below the line.
    """
    front = front_of(points)
    if len(points) < 3 or any(value <= 0.0 for point in points.values() for value in point):
        return None
    corners = [points[name] for name in front]
    slowest = max(time for time, _ in points.values())
    time, error = np.log(np.array([*corners, (slowest, corners[-1][1])])).T
    if time[-1] <= time[0] or error[0] <= error[-1]:
        return None
    # from 0 at the first point to 1 at the last: time spent, and error gained; on the line both are equal
    spent = (time - time[0]) / (time[-1] - time[0])
    gain = (error[0] - error) / (error[0] - error[-1])
    depth = (gain - spent)[: len(front)]
    deepest = int(np.argmax(depth))
    return front[deepest] if depth[deepest] > 1e-12 else None  # a straight curve has rounding alone


@dataclass(frozen=True)
class FidelityResult:
    """The outcome of one fidelity; a library adds its errors and further figures."""

    FIGURES: ClassVar[tuple[str, ...]]
    """Names of the fields that are relative errors; an error of NaN is not known."""

    name: str
    title: str
    cpu_seconds: float
    """CPU seconds of the whole computation."""

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


@brief
@dataclass(frozen=True)
class Frontier(ResultRecord, Generic[R_co]):
    """An accuracy study."""

    results: tuple[R_co, ...]
    """Results in the order of usual cost. The last is the reference of the others, with estimated errors."""
    omitted: dict[str, str] = field(metadata=under_key("left_out"))
    """Name of a fidelity to the reason why it has no result."""
    knee: str | None
    """The fidelity after which more time lowers the largest error least (`knee_of`), or None."""
    chosen: str | None
    """The fidelity of the request."""

    @property
    def reference(self) -> R_co:
        """The finest fidelity that was run."""
        return self.results[-1]


def knee_above(results: Sequence[FidelityResult], *shared: float) -> str | None:
    """Return the name of the fidelity at the knee, by the largest errors.

    Errors below that of the reference, or below `shared` errors of all fidelities, count as equal.
    """
    errors = [error for error in (results[-1].error, *shared) if np.isfinite(error)]
    floor = max(errors, default=0.0)
    known = [result for result in results if np.isfinite(result.error)]
    return knee_of({result.name: (result.cpu_seconds, max(result.error, floor)) for result in known})
