"""From a scene to its result in memory."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dynamics.errors import SolveError
from dynamics.integrators import Cancel, Progress, StaticSolution, Trajectory, integrate, static_equilibrium
from dynamics.integrators.state_sink import States, blocks
from dynamics.integrators.taking_over import Trail
from dynamics.integrators.workspace import Count, Power
from dynamics.results import RunResult
from dynamics.results.run_checks import RunChecks
from dynamics.results.series import over_time
from dynamics.simulate.documents import (
    asked_error,
    documents,
    finer,
    measured_error,
    series_of,
    squared_difference,
)
from dynamics.simulate.error_by_source import error_by_source
from dynamics.simulate.violations import FIRST, EarlierRun, needed_effects, said, taken_over
from dynamics.system import Scene
from dynamics.system.assemble import System, assemble
from dynamics.system.static_reference import with_static_reference
from dynamics.types import FloatArray, Json, RunStatus
from dynamics.worth import Decided, decide_effects
from dynamics.worth.spared_check import SparedChecks


def simulate(scene: Scene, progress: Progress | None = None, cancel: Cancel | None = None) -> RunResult:
    """Run `scene` from static equilibrium at t = 0 over its duration.

    Everything is held in memory: for runs that do not fit there, see `simulate_to_file`.

    Parameters
    ----------
    scene : Scene
    progress : callable, optional
        Called with the fraction done (0..1) and what is being done; what it raises ends the run.
    cancel : callable, optional
        Asked again and again whether to stop; e.g. ``threading.Event().is_set``.

    Returns
    -------
    RunResult
        Complete: its status is `RunStatus.COMPLETED`.

    Raises
    ------
    InputError
        If the scene's parts do not fit each other.
    SolveError
        If there is no equilibrium to start from, the run stopped early or was cancelled, or something that
        it took for granted is wrong and the scene's ``on_violation`` is "fail"; ``partial`` is the result up
        to there.
    """
    decided, before = decide_effects(scene), FIRST
    run = _run(decided, before, None, progress, cancel)
    while needed := _needed(scene, run.result):
        before = before.then(needed, sum(run.result.receipt["seconds"].values()))
        run = _run(before.of(decided), before, run, progress, cancel)
    if progress is not None:
        progress(1.0, "done")
    return run.result


def _needed(scene: Scene, result: RunResult) -> dict[str, str]:
    """Return the effects that a run is to be repeated with; raises where the scene asked for that."""
    wrong = said(result.effect_ledger)
    if wrong and scene.on_violation == "fail":
        raise SolveError(f"assumptions of the run that do not hold: {wrong}", result)
    return needed_effects(result.effect_ledger) if scene.on_violation == "repeat" else {}


@dataclass(frozen=True)
class _Run:
    """A run as made: its result, and what another one needs to go on for it."""

    result: RunResult
    trail: Trail
    trajectory: Trajectory

    def states(self, first: int, stop: int) -> States:
        """Return its samples `first` to `stop` - 1."""
        run = self.trajectory
        return States(run.q, run.v, run.moved).rows(first, stop)


def _run(
    decided: Decided,
    before: EarlierRun,
    earlier: _Run | None,
    progress: Progress | None,
    cancel: Cancel | None,
) -> _Run:
    """Run a scene once; `before` says what of the run `earlier` it repeats."""
    began, scene = clock.perf_counter(), decided.scene
    system = assemble(scene)
    start = static_equilibrium(system)
    seconds = {"assembly_and_equilibrium": clock.perf_counter() - began}
    require_equilibrium(system, start, seconds, decided)
    system, trail = with_static_reference(system, start.displacement), Trail(system)
    taken = None
    if earlier is not None:
        taken = taken_over(earlier.result.effect_ledger, earlier.trail, earlier.states, system)
        before = before if taken is None else replace(before, since=taken.at.time)
    trajectory = integrate(
        system, start, scene.integration, progress, cancel=cancel, trail=trail, taken=taken
    )
    seconds["integration"] = trajectory.seconds
    error = _error_estimate(system, start, trajectory, progress)
    result = _result(system, trajectory, seconds, error, decided, before)
    if not trajectory.status.usable:
        reached = f"at {trajectory.end:.6g} s of {scene.duration:g} s"
        raise SolveError(f"run ended early, {trajectory.status.name.lower()} {reached}", result)
    return _Run(result, trail, trajectory)


def require_equilibrium(
    system: System, start: StaticSolution, seconds: dict[str, float], decided: Decided
) -> None:
    """Refuse to start from anything but an equilibrium.

    Raises
    ------
    SolveError
        If `start` is none; ``partial`` shows where the search for it ended.
    """
    if not start.status.usable:
        message = f"no static equilibrium at t = 0: {start.status.name.lower()}, {start.residual:.3g} N left"
        raise SolveError(message, _result(system, _no_trajectory(system, start), seconds, {}, decided))


def _result(
    system: System,
    trajectory: Trajectory,
    seconds: dict[str, float],
    error: Json,
    decided: Decided,
    before: EarlierRun = FIRST,
) -> RunResult:
    """Put the result together."""
    began = clock.perf_counter()
    checks = RunChecks(system, [SparedChecks(decided)])
    parts: list[dict[str, Any]] = []
    for first, stop in blocks(trajectory.samples):
        part = slice(first, stop)
        states = States(trajectory.q[part], trajectory.v[part], trajectory.moved[part])
        parts.append(series_of(system, trajectory.time[part], states))
        checks.see(parts[-1], states.q)
    seconds = {**seconds, "outputs": clock.perf_counter() - began}
    about = documents(system, trajectory, checks, seconds, error, decided, before)
    return RunResult(**_joined(parts), **about)


def _joined(parts: list[dict[str, Any]]) -> dict[str, Any]:
    """Join blocks of series."""
    if len(parts) == 1:
        return parts[0]
    whole = dict(parts[0])
    for name in over_time():
        whole[name] = np.concatenate([part.pop(name) for part in parts], axis=-1)
    return whole


def _error_estimate(
    system: System, start: StaticSolution, trajectory: Trajectory, progress: Progress | None
) -> Json:
    """Errors by source; that of the steps from a finer run where it is asked for."""
    integration = system.scene.integration
    if not trajectory.status.usable:
        return asked_error(integration)
    states = States(trajectory.q, trajectory.v, trajectory.moved)
    error = error_by_source(system, states.rows, trajectory.samples)
    if not integration.estimate_error:
        return error
    check = integrate(system, start, finer(integration), progress)
    total = squared_difference(system, trajectory.q, check.q)
    return error | measured_error(total, trajectory.samples, len(system.scene.meshes), check.seconds)


def _no_trajectory(system: System, start: StaticSolution) -> Trajectory:
    """Stand for a run that never started: its first sample is where the search for equilibrium ended."""
    q: FloatArray = start.displacement[None, :]
    return Trajectory(
        status=RunStatus.NO_EQUILIBRIUM,
        samples=1,
        time=np.zeros(1),
        q=q,
        v=np.zeros_like(q),
        moved=np.zeros((1, len(system.scene.references)), dtype=np.int64),
        end=0.0,
        stored=np.zeros((2, 3)),
        work=np.zeros(len(Power)),
        count=np.zeros(len(Count), dtype=np.int64),
        step_range=np.zeros(2),
        seconds=0.0,
    )
