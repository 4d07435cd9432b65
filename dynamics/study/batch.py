"""Batches of runs: the tasks that the workers of a study do."""

from __future__ import annotations

import time as clock
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import groupby

from dynamics.errors import DynamicsError
from dynamics.scene import Scene
from dynamics.simulation import run_scene
from dynamics.study.design import Design
from dynamics.study.responses import Response, responses_of
from dynamics.study.scenes import Scenes
from model_studies import LeftOut

RUNS = 8
"""At most in a batch: what an interruption loses of each worker. It does not depend on who does the tasks."""

NAN = float("nan")

Batch = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class StudyTask:
    """What all batches of a study share.

    Attributes
    ----------
    scenes : Scenes
    factors : tuple of str
        Their names.
    responses : tuple of Response
    start : float
        Time from which on responses are taken, s.
    receipt : "minimal" or "full"
        Of each run; "full" measures its errors.
    """

    scenes: Scenes
    factors: tuple[str, ...]
    responses: tuple[Response, ...]
    start: float = 0.0
    receipt: str = "minimal"

    def scene(self, values: tuple[float, ...]) -> Scene:
        """Return the scene at a point, as it is run on its own."""
        return self.scenes.scene(dict(zip(self.factors, values, strict=True)))


@dataclass(frozen=True)
class PointResult:
    """What a study keeps of one run.

    Attributes
    ----------
    figures, errors : list of float
        Of the responses, in SI; NaN where there is none.
    reason : str
        Why the run has no figures; empty where it has.
    seconds : list of float
        Of this thread for all of it, and of the time integration (wall time), s.
    """

    figures: list[float]
    errors: list[float]
    reason: str
    seconds: list[float]


def batches(design: Design, scenes: Scenes) -> Iterator[tuple[tuple[int, ...], Batch]]:
    """Yield indices and values of the points of each batch.

    Points that share what is expensive are in a row, so that it is made once for all of them.
    """
    values = [tuple(map(float, row)) for row in design.points]
    shared = [tuple(scenes.expensive(dict(zip(design.names, row, strict=True))).items()) for row in values]
    order = sorted(range(len(values)), key=lambda k: (shared[k], k))
    for _, group in groupby(order, key=lambda k: shared[k]):
        points = list(group)
        for first in range(0, len(points), RUNS):
            some = tuple(points[first : first + RUNS])
            yield some, tuple(values[k] for k in some)


def run_batch(task: StudyTask, batch: Batch) -> list[PointResult]:
    """Run the points of a batch."""
    return [_run_point(task, values) for values in batch]


def _run_point(task: StudyTask, values: tuple[float, ...]) -> PointResult:
    """Run one point; what fails is a marked point with its reason."""
    began, integration, none = clock.thread_time(), NAN, [NAN] * len(task.responses)
    try:
        run = run_scene(as_studied(task.scene(values), task.receipt))
        integration = float(run.receipt["seconds"]["integration"])
        figures, errors = responses_of(run, task.responses, task.start)
        reason = ""
    except (LeftOut, DynamicsError) as error:
        figures, errors, reason = none, none, str(error)
    except MemoryError:
        figures, errors, reason = none, none, "out of memory"
    return PointResult(figures, errors, reason, [clock.thread_time() - began, integration])


def as_studied(scene: Scene, receipt: str) -> Scene:
    """Return the scene of a point with what a study stores of it: the motion is the same to the last bit."""
    outputs = replace(
        scene.outputs, receipt=receipt, energy_audit=False, displacements=False, accelerations=False
    )
    return replace(scene, outputs=outputs)


def stated(receipt: str) -> tuple[str, ...]:
    """Return what the runs of a study do without, in words."""
    windows = () if receipt == "full" else ("errors of steps and tables measured in windows of the run",)
    return ("energy audit", *windows, *(() if receipt == "full" else ("estimated influence of effects",)))
