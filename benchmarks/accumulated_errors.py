"""Do stated errors of runs cover accumulated ones? Impacts, reversals, light damping, steady contact.

Each scene runs as a caller runs it, at 1 nm. The truth is a run at 1e-4 of the tolerance; where the motion is
chaotic, of the level of the transmission error.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from benchmarks.accumulated_error_cases import ACCUMULATING, STEADY, scenes
from benchmarks.figures import Figure
from bounds import PlausibilityWarning
from dynamics.results import RunResult
from dynamics.scene import Outputs, Scene
from dynamics.simulation import simulate
from dynamics.types import FloatArray

SUBJECT = "stated step errors of runs against a ten thousandth of the tolerance"
FINER = 1e-4
MIN, MAX, COVERED = 0.3, 3.0, 11.0 / 12.0
"""True over stated errors, and the share of the scenes with errors that accumulate that are to be covered."""


@dataclass(frozen=True)
class StatedRun:
    """The step error of a scene as stated, and the true one, m rms."""

    name: str
    stated: float
    true: float
    chaotic: bool
    cost: float
    """CPU time of the error estimates over that of the integration."""

    @property
    def ratio(self) -> float:
        """True over stated error; 0 where both are."""
        return self.true / self.stated if self.true > 0.0 else 0.0


def stated_run(name: str, scene: Scene) -> StatedRun:
    """Run a scene and its truth."""
    reported = replace(scene, on_violation="report")
    bare = Outputs(scene.outputs.sample_rate, energy_audit=False, receipt="minimal", anti_alias=False)
    fine = replace(scene.integration, tolerance=FINER * scene.integration.tolerance)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PlausibilityWarning)
        run, truth = simulate(reported), simulate(replace(reported, outputs=bare, integration=fine))
    seconds, steps = run.receipt["seconds"], run.receipt["error"]["time_step"]
    chaotic = bool(steps.get("chaotic", False))
    true = _level_error(run, truth) if chaotic else _trace_error(run, truth)
    return StatedRun(
        name, float(steps["rms"]), true, chaotic, seconds["error_estimate"] / seconds["integration"]
    )


def _trace_error(run: RunResult, truth: RunResult) -> float:
    return _rms(run.dynamic_transmission_error - truth.dynamic_transmission_error)


def _level_error(run: RunResult, truth: RunResult) -> float:
    """Return the largest difference of the rms of transmission errors about their means, m."""
    level = [np.std(of.dynamic_transmission_error, axis=1) for of in (run, truth)]
    return float(np.max(np.abs(level[0] - level[1])))


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


@cache
def assessed() -> Mapping[str, StatedRun]:
    """Assess all scenes; each runs twice, the first time to compile."""
    runs: dict[str, StatedRun] = {}
    for name, scene in scenes().items():
        stated_run(name, scene)
        runs[name] = stated_run(name, scene)
    return runs


def figures() -> list[Figure]:
    """Return true over stated errors, the uncovered share, and the cost of the estimates."""
    runs = assessed()
    uncovered = sum(runs[name].ratio > 1.0 for name in ACCUMULATING)
    return [
        *(_ratio(runs[name]) for name in runs),
        Figure(SUBJECT, "covered among those that accumulate", 1.0 - uncovered / len(ACCUMULATING), "-"),
        Figure(SUBJECT, "not covered among them", uncovered / len(ACCUMULATING), "-", 1.0 - COVERED + 1e-12),
        Figure(SUBJECT, "least ratio", min(run.ratio for run in runs.values()), "-"),
        Figure(
            SUBJECT,
            "estimates over integration, worst in steady contact",
            max(runs[name].cost for name in STEADY),
            "-",
        ),
    ]


def _ratio(run: StatedRun) -> Figure:
    of = "level" if run.chaotic else "trace"
    return Figure(SUBJECT, f"{run.name}: true over stated, {of}", run.ratio, "-", MAX)
