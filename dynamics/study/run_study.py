"""From a design to the figures of all its runs."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from dynamics.checks import integer, within
from dynamics.errors import DynamicsError, InputError
from dynamics.simulation import simulate_to_file
from dynamics.study.batch import PointResult, StudyTask, batches, run_batch, stated
from dynamics.study.design import Design
from dynamics.study.result import Study
from dynamics.study.scenes import OneByOne, Workers
from dynamics.types import FloatArray, IntArray
from model_studies import Progress, silent


def study(
    task: StudyTask,
    design: Design,
    workers: Workers = OneByOne(),  # noqa: B008 (no state)
    progress: Progress = silent,
    *,
    confidence: float = 0.95,
    keep_worst: int = 0,
) -> Study:
    """Run all points of a design and take the responses of each.

    Figures are those of `dynamics.simulate` of each scene alone, to the last bit, whoever does the tasks.
    Runs themselves are not kept: memory does not grow with their length.

    Parameters
    ----------
    task : StudyTask
        Its factors are those of the design.
    design : Design
    workers : Workers
        Who does the batches: this process, an executor of threads or processes, a cluster.
    progress : callable
        Called as progress("runs", fraction).
    confidence : float
        Of the bounds of quantiles.
    keep_worst : int
        How many points of the largest first response to name in `Study.worst`; see `keep_runs`.

    Raises
    ------
    InputError
        A design that is not of these factors, or figures out of bounds.
    """
    if task.factors != design.names:
        raise InputError("design.factors", design.names, f"those of the task: {', '.join(task.factors)}")
    within("confidence", confidence, 0.5, 0.9999)
    count = len(design.points)
    integer("keep_worst", keep_worst, 0, count)
    results: list[PointResult | None] = [None] * count
    parts = list(batches(design, task.scenes))
    done, batch_results = 0, workers.run(run_batch, task, [values for _, values in parts])
    for (indices, _), points in zip(parts, batch_results, strict=True):
        for index, point in zip(indices, points, strict=True):
            results[index] = point
        done += len(indices)
        progress("runs", done / count)
    return _result(task, design, [point for point in results if point is not None], confidence, keep_worst)


def keep_runs(task: StudyTask, study: Study, folder: Path, progress: Progress = silent) -> list[Path]:
    """Run the worst points of a study again as the scene asks, with all its checks; return their files.

    A run that all its checks refuse, such as the energy audit, leaves the file that `simulate_to_file` does.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for count, index in enumerate(study.worst):
        file = folder / f"point_{int(index)}.nc"
        with suppress(DynamicsError):
            simulate_to_file(task.scene(tuple(map(float, study.value[index]))), file)
        if file.is_file():
            files.append(file)
        progress("worst cases", (count + 1) / len(study.worst))
    return files


def _result(
    task: StudyTask, design: Design, points: Sequence[PointResult], confidence: float, keep_worst: int
) -> Study:
    """Put the result together."""
    figure = np.array([point.figures for point in points])
    return Study(
        design.names,
        tuple(factor.kind for factor in design.factors.values()),
        tuple(response.title for response in task.responses),
        tuple(response.kind.unit for response in task.responses),
        design.points,
        figure,
        np.array([point.errors for point in points]),
        tuple(point.reason for point in points),
        np.array([point.seconds for point in points]),
        design.samples,
        confidence,
        _worst(figure[:, 0], keep_worst),
        {
            "seed": design.seed,
            "start": task.start,
            "receipt": task.receipt,
            "neglected": stated(task.receipt),
        },
    )


def _worst(first: FloatArray, count: int) -> IntArray:
    """Return the points of the largest values, the largest first; failed ones are none."""
    usable = np.flatnonzero(np.isfinite(first))
    return usable[np.argsort(-first[usable], kind="stable")][:count]
