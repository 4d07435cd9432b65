"""Predicted cost of the runs of a scene, measured on a few of their steps."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

import numpy as np

from dynamics.errors import InputError, SolveError
from dynamics.scene import Scene
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.scene_before_tables import SceneText, moving_before_tables, scene_in_motion

if TYPE_CHECKING:
    from dynamics.simulation.run_cost import ProbedRun

Receipt = Literal["minimal", "full"]


def runs_cost(
    scene: SceneInput,
    runs: Callable[[Scene], tuple[list[float], float]],
    stage: str,
    receipt: Receipt | None = None,
) -> StudyCost | None:
    """Return the cost of runs of a scene: number of runs times steps, and CPU seconds outside the steps.

    `stage`: the stage that reports the runs. None: nothing predicts the cost.
    """
    cost = run_cost(scene, receipt=receipt)
    before = None if cost is None else moving_before_tables(scene)
    if cost is None or before is None:
        return None
    try:
        times, extra_seconds = runs(before)
    except (InputError, SolveError):
        return None
    per_run = cost.seconds * float(np.mean(times)) + extra_seconds if times else 0.0
    return StudyCost((Work("runs", per_run, len(times), stage),))


def run_cost(scene: SceneInput, runs: int = 1, receipt: Receipt | None = None) -> StudyCost | None:
    """Return the cost of so many runs of a scene, measured on some steps; None: nothing predicts it.

    `receipt`: of the runs; None: as the scene says. Modes that a solid housing keeps are not known before
    and do not count. Raises `BadInput`: no such scene.
    """
    with boundary_errors():
        before = moving_before_tables(scene)
    if before is None:
        return None
    full = (receipt or before.outputs.receipt) == "full"
    try:
        probed = _probed(SceneText(scene.model_dump_json(), scene))
    except (InputError, SolveError):
        return None  # the run itself will raise, on the computed tables
    with_errors = full and bool(before.meshes)
    seconds = probed.seconds(runs, with_errors=with_errors)
    return StudyCost((Work("run" if runs == 1 else "runs", seconds / runs, runs),))


@lru_cache(1)
def _probed(text: SceneText) -> ProbedRun:
    from dynamics.simulation.run_cost import probe_run  # noqa: PLC0415 (start-up time)

    before = scene_in_motion(text)
    assert before is not None  # checked by the caller
    return probe_run(before)
