"""The door: from a scene to its result."""

from __future__ import annotations

import time as clock
from dataclasses import replace

import numpy as np

from dynamics.errors import SolveError
from dynamics.integrators import Progress, StaticSolution, Trajectory, integrate, static_equilibrium
from dynamics.integrators.workspace import Count
from dynamics.results import EnergyAudit, RunResult, StepStatistics
from dynamics.results.case import resolved_case
from dynamics.results.contact_check import contact_checks
from dynamics.results.histories import histories
from dynamics.system import Scene
from dynamics.system.assemble import System, assemble
from dynamics.types import FloatArray, Json, RunStatus

ERROR_CHECK_FACTOR = 0.1
IMPLICIT_STAGES_PER_STEP = 5


def simulate(scene: Scene, progress: Progress | None = None) -> RunResult:
    """Run `scene` from static equilibrium at t = 0 over its duration.

    Parameters
    ----------
    scene : Scene
    progress : callable, optional
        Called with the fraction done (0..1) and what is being done; what it raises ends the run.

    Returns
    -------
    RunResult
        Complete: its status is `RunStatus.COMPLETED`.

    Raises
    ------
    InputError
        If the scene's parts do not fit each other.
    SolveError
        If there is no equilibrium to start from, or the run stopped early; ``partial`` is the result up to
        there.
    """
    began = clock.perf_counter()
    system = assemble(scene)
    start = static_equilibrium(system)
    seconds = {"assembly_and_equilibrium": clock.perf_counter() - began}
    if not start.status.usable:
        message = f"no static equilibrium at t = 0: {start.status.name.lower()}, {start.residual:.3g} N left"
        raise SolveError(message, _result(system, _no_trajectory(system, start), seconds, {}))
    trajectory = integrate(system, start, scene.integration, progress)
    seconds["integration"] = trajectory.seconds
    error = _error_estimate(system, start, trajectory, progress)
    result = _result(system, trajectory, seconds, error)
    if not trajectory.status.usable:
        reached = f"at {trajectory.end:.6g} s of {scene.duration:g} s"
        raise SolveError(f"run ended early, {trajectory.status.name.lower()} {reached}", result)
    if progress is not None:
        progress(1.0, "done")
    return result


def _result(system: System, trajectory: Trajectory, seconds: dict[str, float], error: Json) -> RunResult:
    """Put the result together."""
    began = clock.perf_counter()
    series = histories(system, trajectory.time, trajectory.q, trajectory.v, trajectory.moved)
    flanks = (series[name] for name in ("position", "dynamic_transmission_error", "mesh_force"))
    checks = contact_checks(system, *flanks)
    audit = EnergyAudit.from_arrays(trajectory.work, trajectory.stored)
    seconds = {**seconds, "outputs": clock.perf_counter() - began}
    return RunResult(
        **series,
        status=trajectory.status,
        statistics=_statistics(system, trajectory),
        energy=audit if system.scene.outputs.energy_audit else None,
        effect_ledger={**system.ledger.to_json(), "checks": checks},
        receipt={"seconds": seconds, "error": error},
        case=resolved_case(system),
    )


def _statistics(system: System, trajectory: Trajectory) -> StepStatistics:
    """Name the counts."""
    count = [int(value) for value in trajectory.count]
    implicit = system.scene.integration.method == "implicit"
    stages = IMPLICIT_STAGES_PER_STEP * max(count[Count.ACCEPTED] + count[Count.REJECTED], 1)
    return StepStatistics(
        count[Count.ACCEPTED],
        count[Count.REJECTED],
        count[Count.NEWTON_FAILED],
        count[Count.NEWTON_TOTAL] / stages if implicit else 0.0,
        count[Count.NEWTON_MOST],
        float(trajectory.step_range[0]),
        float(trajectory.step_range[1]),
    )


def _error_estimate(
    system: System, start: StaticSolution, trajectory: Trajectory, progress: Progress | None
) -> Json:
    """Step error of the transmission error, m rms: asked for, or measured against a finer run."""
    integration = system.scene.integration
    if not (integration.estimate_error and trajectory.status.usable):
        return {
            "time_step": {"rms": integration.tolerance, "unit": "m", "source": "tolerance of step control"}
        }
    finer = replace(
        integration,
        tolerance=ERROR_CHECK_FACTOR * integration.tolerance,
        fixed_step=integration.fixed_step and ERROR_CHECK_FACTOR * integration.fixed_step,
    )
    check = integrate(system, start, finer, progress)
    difference = (trajectory.q - check.q) @ system.arrays.direction[: len(system.scene.meshes)].T
    rms = float(np.sqrt(np.mean(difference**2))) if difference.size else 0.0
    source = f"difference from a run at {ERROR_CHECK_FACTOR:g} of the tolerance"
    return {"time_step": {"rms": rms, "unit": "m", "source": source, "seconds": check.seconds}}


def _no_trajectory(system: System, start: StaticSolution) -> Trajectory:
    """Stand for a run that never started: its first sample is where the search for equilibrium ended."""
    q: FloatArray = start.displacement[None, :]
    return Trajectory(
        status=RunStatus.NO_EQUILIBRIUM,
        time=np.zeros(1),
        q=q,
        v=np.zeros_like(q),
        moved=np.zeros((1, len(system.scene.references)), dtype=np.int64),
        end=0.0,
        stored=np.zeros((2, 3)),
        work=np.zeros(5),
        count=np.zeros(len(Count), dtype=np.int64),
        step_range=np.zeros(2),
        seconds=0.0,
    )
