"""Laws of every scene in the time domain: two integrators agree, and the energy balance closes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from dynamics.results import RunResult
from dynamics.scene import Scene
from dynamics.simulation import simulate
from dynamics.types import FloatArray
from lineofaction.hardcases.scene import Measured

METHODS = ("implicit", "explicit")
LARGEST_GROWTH = 100.0
"""Largest ratio of an error to the tolerance of a run. With larger ratios the motion amplifies errors so much
that agreement within measured errors says little."""
LARGEST_RATIO = 1.25
"""A measured error is 1.2 times the difference to a run at a tenth of the tolerance, for that run's error: a
sixth as large on average, more where a step level (2^(1/4), 2 in errors of order 4) rounds against it."""
LARGEST_MISSING = 1e-3
"""Largest missing energy over the energy turned over, as the documentation promises."""


@dataclass(frozen=True)
class _Runs:
    """The same scene by both integrators."""

    implicit: RunResult
    explicit: RunResult

    @property
    def both(self) -> tuple[RunResult, RunResult]:
        """The runs."""
        return self.implicit, self.explicit


def run_both(scene: Scene) -> _Runs:
    """Run `scene` by both integrators, each at the tolerance of the scene, and take points of the motion."""
    points = replace(scene, outputs=replace(scene.outputs, anti_alias=False))
    return _Runs(*(simulate(by_method(points, method)) for method in METHODS))


def by_method(scene: Scene, method: str) -> Scene:
    """Return the scene with another integrator."""
    return replace(scene, integration=replace(scene.integration, method=method))


def common_figures(runs: _Runs, scene: Scene) -> tuple[Measured, ...]:
    """Return the difference of both integrators, and the energy that the worse one misses.

    They agree to their tolerances; where the scene has errors measured (`Integration.estimate_error`), since
    its motion makes more of an error than one tolerance, to these.
    """
    first, second = (run.dynamic_transmission_error for run in runs.both)
    difference, tolerance = rms(first - second), scene.integration.tolerance
    audits = [run.energy for run in runs.both if run.energy is not None]
    energy = Measured(
        "energy missing, over what was turned over", max(audit.relative for audit in audits), LARGEST_MISSING
    )
    if not scene.integration.estimate_error:
        return (
            Measured("two integrators apart, rms over both tolerances", difference / (2.0 * tolerance), 1.0),
            energy,
        )
    errors = [_measured_error(run) for run in runs.both]
    return (
        Measured(
            "two integrators apart, rms over their measured errors", difference / sum(errors), LARGEST_RATIO
        ),
        Measured("larger measured error over the tolerance", max(errors) / tolerance, LARGEST_GROWTH),
        energy,
    )


def off_closed_form(runs: _Runs, scene: Scene, exact: Callable[[FloatArray], FloatArray]) -> Measured:
    """Return the rms distance of the worse integrator from `exact`, over the tolerance or its error."""
    off = [rms(run.dynamic_transmission_error[0] - exact(run.time)) for run in runs.both]
    if not scene.integration.estimate_error:
        return Measured(
            "off the closed form, rms over the tolerance", max(off) / scene.integration.tolerance, 1.0
        )
    ratio = max(distance / _measured_error(run) for distance, run in zip(off, runs.both, strict=True))
    return Measured("off the closed form, rms over the measured error", ratio, LARGEST_RATIO)


def _measured_error(run: RunResult) -> float:
    """Return the rms error that a run states, m."""
    return float(run.receipt["error"]["time_step"]["rms"])


def rms(values: FloatArray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
