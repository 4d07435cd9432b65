"""The figures of all runs of a design.

A factor is a value of the scene that varies, a response a figure of each run. A point is one combination of
factors; the points of a batch share values that take long to prepare, such as tables.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import groupby
from pathlib import Path
from typing import ClassVar, Protocol

import numpy as np

from bounds.brief import brief
from bounds.plottable import Plottable
from dynamics.checks import integer, within
from dynamics.errors import DynamicsError, InputError
from dynamics.influence import Decision, decide_effects
from dynamics.results.array_file import ArrayFile, stored
from dynamics.scene import Scene
from dynamics.simulation import run_scene, simulate_to_file, undescribed
from dynamics.study.design import Design
from dynamics.study.effect_decision import PointDecision, StudyEffects, decision_points
from dynamics.study.responses import Response, responses_of
from dynamics.types import FloatArray, IntArray, Json
from host import keep_freed_memory
from model_studies import LeftOut, Progress, silent
from model_studies.record import under_key
from model_studies.spread import quantile_bounds, rank_correlation
from model_studies.workers import InProcess, Workers, task_cpu_seconds

FRACTIONS = (0.05, 0.5, 0.95)  # fractions of the quantiles that are stated
RUNS = 8
"""Most runs in a batch, which an interruption loses of each worker. The number is the same for all kinds of
workers.
"""
NAN = float("nan")
Batch = tuple[tuple[float, ...], ...]
NEGLECTED = ("errors of steps and tables measured in windows of the run", "estimated influence of effects")
"""Work that runs with a minimal receipt leave out."""


@dataclass(frozen=True)
class _Spread:
    """The distribution of a response over the samples of each of C combinations of grid and list."""

    mean: FloatArray
    standard_error: FloatArray
    """`mean`, `standard_error`: Mean of the usable samples and its standard error; NaN where there is no
    sample, or only one. Shape (C,) each.
    """
    fraction: FloatArray
    """Fractions of the quantiles. Shape (Q,)."""
    quantile: FloatArray
    low: FloatArray
    high: FloatArray
    """`quantile`, `low`, `high`: Estimates and confidence bounds, infinite where the sample is too small for
    a bound. Shape (C, Q) each.
    """


@brief
@dataclass(frozen=True)
class Study(ArrayFile, Plottable):
    """The figures of N runs: f factors, r responses."""

    factor: tuple[str, ...]
    kind: tuple[str, ...]
    """`factor`, `kind`: Names of the factors, and "grid", "list", "normal" or "uniform"."""
    response: tuple[str, ...]
    unit: tuple[str, ...]
    """`response`, `unit`: Titles and SI units of the responses."""
    value: FloatArray = field(
        metadata=stored("", "values of the factors, in the units of their names", "point", "factor")
    )
    """Values of the factors, in the units of their names. Shape (N, f)."""
    figure: FloatArray = field(metadata=stored("", "responses, in their SI units", "point", "response"))
    error: FloatArray = field(metadata=stored("", "stated errors of the responses", "point", "response"))
    """`figure`, `error`: Responses, and their errors where the run states them, else NaN. A failed run has
    NaN in all. Shape (N, r) each.
    """
    reason: tuple[str, ...]
    """Reason why a run has no figures; empty where it has them."""
    seconds: FloatArray = field(
        metadata=stored("s", "CPU time in all, and of the integration", "point", "cost")
    )
    """CPU time of each run in all, and of its integration, s. Shape (N, 2)."""
    samples: int
    """Number of samples of each combination of grid and list, in a row."""
    confidence: float
    """Confidence of the bounds of quantiles."""
    worst: IntArray = field(metadata=stored("", "points kept as full runs", "kept"))
    """Points whose first response is largest, which are kept as full runs. Shape (k,)."""
    metadata: Json = field(metadata=under_key("facts"))
    """Plain JSON: design, start, receipt, the work that the runs leave out, and the decision on effects."""

    SCHEMA: ClassVar[str] = "lineofaction study"

    @property
    def usable(self) -> int:
        """Number of runs that have figures."""
        return sum(not reason for reason in self.reason)

    def column(self, response: int) -> FloatArray:
        """Return a response (C, samples) by combination and sample."""
        return self.figure[:, response].reshape(-1, self.samples)

    def spread(self, response: int) -> _Spread:
        """Return the distribution of a response over the samples of each combination."""
        rows = [row[np.isfinite(row)] for row in self.column(response)]
        bounds = [[_bounds(row, fraction, self.confidence) for fraction in FRACTIONS] for row in rows]
        quantile, low, high = np.moveaxis(np.array(bounds), -1, 0)
        return _Spread(
            np.array([row.mean() if row.size else np.nan for row in rows]),
            np.array([row.std(ddof=1) / np.sqrt(row.size) if row.size > 1 else np.nan for row in rows]),
            np.array(FRACTIONS),
            quantile,
            low,
            high,
        )

    def level_means(self, factor: int, response: int) -> tuple[FloatArray, FloatArray]:
        """Return the values of a factor of grid or list, and the mean response over all else at each."""
        values = np.unique(self.value[:, factor])
        column = self.figure[:, response]
        selected = (column[(self.value[:, factor] == value) & np.isfinite(column)] for value in values)
        return values, np.array([part.mean() if part.size else np.nan for part in selected])

    def swing(self, factor: int, response: int) -> float:
        """Return the effect of a factor of the grid or the list: the spread of the means of its levels."""
        _, means = self.level_means(factor, response)
        return float(np.nanmax(means) - np.nanmin(means)) if np.isfinite(means).any() else float("nan")

    def correlation(self, response: int) -> FloatArray:
        """Return Spearman's rank correlation (f,) of sampled factors with a response, NaN for the others.

        Taken within each combination of grid and list, and the mean over them.
        """
        sampled = [k for k, kind in enumerate(self.kind) if kind in ("normal", "uniform")]
        result, rows = np.full(len(self.factor), np.nan), []
        if not sampled:
            return result
        about = np.median(self.value[:, sampled], axis=0)
        values = (self.value[:, sampled] - about).reshape(-1, self.samples, len(sampled))
        for deviation, column in zip(values, self.column(response), strict=True):
            usable = np.isfinite(column)
            if np.count_nonzero(usable) > 2:
                rows.append(rank_correlation(deviation[usable], column[usable, None])[:, 0])
        if rows:
            result[sampled] = np.mean(rows, axis=0)
        return result


def _bounds(row: FloatArray, fraction: float, confidence: float) -> tuple[float, float, float]:
    """Quantile and bounds of the usable samples of one combination."""
    if not row.size:
        return float("nan"), -np.inf, np.inf
    value, low, high = quantile_bounds(row[:, None], fraction, confidence)
    return float(value[0]), float(low[0]), float(high[0])


class Scenes(Protocol):
    """Makes scenes of one structure; can be pickled, and is frozen data that has a content hash."""

    def scene(self, values: Mapping[str, float]) -> Scene:
        """Return the scene at values of the factors, by name.

        Raises `LeftOut`, `DynamicsError`: there is no such scene, and why.
        """
        ...

    def expensive(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """Return the values that decide parts which take longer to make than a run, such as a table."""
        ...


@dataclass(frozen=True)
class StudyTask:
    """Task that all batches of a study share."""

    scenes: Scenes
    factors: tuple[str, ...]
    """Names of the factors."""
    responses: tuple[Response, ...]
    start: float = 0.0
    """Time from which on responses are taken, s."""
    receipt: str = "minimal"
    """Receipt of each run; "full" measures its errors."""
    effects: StudyEffects | None = None
    """Decision on effects for all runs, by `with_effects`; None: every run decides by itself."""

    def scene(self, values: tuple[float, ...]) -> Scene:
        """Return the scene at a point, as it is run on its own."""
        return self.scenes.scene(dict(zip(self.factors, values, strict=True)))

    def lean_scene(self, values: tuple[float, ...]) -> Scene:
        """Return the scene at a point with the outputs that the responses need."""
        scene = self.scene(values)
        stored = {"energy_audit": False, "displacements": False, "accelerations": False}
        return replace(scene, outputs=replace(scene.outputs, receipt=self.receipt, **stored))

    def decide(self, scene: Scene) -> Decision:
        """Return the decision on the effects of a run."""
        return decide_effects(scene) if self.effects is None else self.effects.decision(scene)


@dataclass(frozen=True)
class _PointResult:
    """Figures of one run that a study keeps."""

    figures: list[float]
    errors: list[float]
    """`figures`, `errors`: Responses and their errors, SI; NaN where there is none."""
    reason: str
    """Reason why the run has no figures; empty where it has them."""
    seconds: list[float]
    """CPU time of the whole run and of its time integration, s."""


def _batches(design: Design, scenes: Scenes) -> Iterator[tuple[tuple[int, ...], Batch]]:
    """Yield indices and values of the points of each batch.

    Points that share what is expensive are in a row, so that it is made once for all of them.
    """
    values = [tuple(map(float, row)) for row in design.points]
    shared = [tuple(scenes.expensive(dict(zip(design.names, row, strict=True))).items()) for row in values]
    order = sorted(range(len(values)), key=lambda k: (shared[k], k))
    for _, group in groupby(order, key=lambda k: shared[k]):
        points = list(group)
        for first in range(0, len(points), RUNS):
            batch = tuple(points[first : first + RUNS])
            yield batch, tuple(values[k] for k in batch)


def _run_batch(task: StudyTask, batch: Batch) -> list[_PointResult]:
    """Run the points of a batch."""
    keep_freed_memory()
    return [_run_point(task, values) for values in batch]


def _run_point(task: StudyTask, values: tuple[float, ...]) -> _PointResult:
    """Run one point; a run that fails is a marked point with its reason."""
    began, integration, none = task_cpu_seconds(), NAN, [NAN] * len(task.responses)
    try:
        run = run_scene(task.lean_scene(values), describe=undescribed, decide=task.decide)
        integration = float(run.receipt["seconds"]["integration"])
        figures, errors = responses_of(run, task.responses, task.start)
        reason = ""
    except (LeftOut, DynamicsError) as error:
        figures, errors, reason = none, none, str(error)
    except MemoryError:
        figures, errors, reason = none, none, "out of memory"
    return _PointResult(figures, errors, reason, [task_cpu_seconds() - began, integration])


def _decide_point(task: StudyTask, values: tuple[float, ...]) -> PointDecision | None:
    """Decide the effects at one point; None: there is no such scene."""
    began = task_cpu_seconds()
    try:
        decision = PointDecision.of(task.lean_scene(values))
        return replace(decision, seconds=task_cpu_seconds() - began)
    except (LeftOut, DynamicsError):
        return None


def with_effects(
    task: StudyTask,
    design: Design,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
    progress: Progress = silent,
) -> StudyTask:
    """Return the task with one decision on effects for all its runs at the points of a design.

    `progress` is called as progress("effects", fraction).
    """
    points = [tuple(map(float, row)) for row in decision_points(design.points, design.kinds)]
    decisions = []
    for count, decision in enumerate(workers.run(_decide_point, task, points), start=1):
        if decision is not None:
            decisions.append(decision)
        progress("effects", count / len(points))
    return replace(task, effects=StudyEffects.of(decisions))


def study(
    task: StudyTask,
    design: Design,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
    progress: Progress = silent,
    *,
    confidence: float = 0.95,
    keep_worst: int = 0,
) -> Study:
    """Run all points of a design and take the responses of each.

    Figures are those of `dynamics.simulate` of each scene alone with the effects of the task, to the last
    bit, whoever does the tasks. Runs themselves are not kept: memory does not grow with their length. Raises
    `InputError`: a design that is not of these factors, or figures out of bounds.

    Parameters
    ----------
    task : StudyTask
        Task whose factors are those of the design.
    design : Design
    workers : Workers
        Who does the batches: this process, an executor of threads or processes, a cluster.
    progress : callable
        Called as progress("runs", fraction).
    confidence : float
        Confidence of the bounds of quantiles.
    keep_worst : int
        Number of points with the largest first response that `Study.worst` names; see `keep_runs`.
    """
    if task.factors != design.names:
        raise InputError("design.factors", design.names, f"those of the task: {', '.join(task.factors)}")
    within("confidence", confidence, 0.5, 0.9999)
    count = len(design.points)
    integer("keep_worst", keep_worst, 0, count)
    results: list[_PointResult | None] = [None] * count
    parts = list(_batches(design, task.scenes))
    done, batch_results = 0, workers.run(_run_batch, task, [values for _, values in parts])
    for (indices, _), points in zip(parts, batch_results, strict=True):
        for index, point in zip(indices, points, strict=True):
            results[index] = point
        done += len(indices)
        progress("runs", done / count)
    return _result(task, design, [point for point in results if point is not None], confidence, keep_worst)


def keep_runs(task: StudyTask, study: Study, folder: Path, progress: Progress = silent) -> list[Path]:
    """Run the worst points of a study again as the scene asks, with all its checks; return their files.

    `task` is that of the study, with its effects. A run that all its checks refuse, such as the energy audit,
    leaves the file that `simulate_to_file` does.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for count, index in enumerate(study.worst, start=1):
        file = folder / f"point_{int(index)}.nc"
        with suppress(DynamicsError):
            simulate_to_file(task.scene(tuple(map(float, study.value[index]))), file, decide=task.decide)
        if file.is_file():
            files.append(file)
        progress("worst cases", count / len(study.worst))
    return files


def _result(
    task: StudyTask, design: Design, points: Sequence[_PointResult], confidence: float, keep_worst: int
) -> Study:
    figure = np.array([point.figures for point in points])
    usable = np.flatnonzero(np.isfinite(figure[:, 0]))
    worst = usable[np.argsort(-figure[usable, 0], kind="stable")][:keep_worst]
    return Study(
        factor=design.names,
        kind=design.kinds,
        response=tuple(response.title for response in task.responses),
        unit=tuple(response.kind.unit for response in task.responses),
        value=design.points,
        figure=figure,
        error=np.array([point.errors for point in points]),
        reason=tuple(point.reason for point in points),
        seconds=np.array([point.seconds for point in points]),
        samples=design.samples,
        confidence=confidence,
        worst=worst,
        metadata={
            "seed": design.seed,
            "start": task.start,
            "receipt": task.receipt,
            "neglected": ("energy audit", *(() if task.receipt == "full" else NEGLECTED)),
            "effects": None if task.effects is None else task.effects.to_json(),
        },
    )
