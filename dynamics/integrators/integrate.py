"""A whole run: from equilibrium, in chunks with progress, to a trajectory with its status."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dynamics.integrators.advance import advance
from dynamics.integrators.energy import stored_energy
from dynamics.integrators.static import StaticSolution
from dynamics.integrators.step_control import Control
from dynamics.integrators.tableaus import EXPLICIT_EMBEDDED_ORDER, IMPLICIT_EMBEDDED_ORDER
from dynamics.integrators.workspace import Count, Workspace, make_workspace, step_ladder
from dynamics.system import Integration
from dynamics.system.assemble import System
from dynamics.types import FloatArray, IntArray, RunStatus

Progress = Callable[[float, str], None]

CHUNKS = 50
FIRST_STEP = 1e-6
STEP_SHARE = 0.07
"""Error allowed per step over the tolerance of the run.

Measured on the run-up of a spur pair: with it the rms error of the run is 0.2 of the tolerance at damping
ratios of 0.05, and 0.8 at 0.01, where steps' errors ring five times longer."""
NEWTON_SHARE = 0.01
"""Error of Newton's method over the error allowed per step."""


@dataclass(frozen=True)
class Trajectory:
    """A run as computed.

    Attributes
    ----------
    status : RunStatus
    time : (T,) array
        Output grid as far as the run came, s.
    q, v : (T, n) arrays
        Deviations from the kinematic motion and their rates.
    moved : (T, k) int array
        Quanta of a revolution by which each free train's own rotation was moved into the kinematic motion.
    end : float
        Time of the last step's end, s; the energies refer to it.
    stored : (2, 3) array
        Kinetic, bushing and mesh energy at the start and at the end, J.
    work : (5,) array
        Works over the run, J, in the order of `Power`.
    count : (9,) int array
        Statistics, in the order of `Count`.
    step_range : (2,) array
        Smallest and largest accepted step, s.
    seconds : float
        Wall time of the stepping, s; in a process's first run with reading or making the compiled code.
    """

    status: RunStatus
    time: FloatArray
    q: FloatArray
    v: FloatArray
    moved: IntArray
    end: float
    stored: FloatArray
    work: FloatArray
    count: IntArray
    step_range: FloatArray
    seconds: float


def integrate(
    system: System,
    start: StaticSolution,
    integration: Integration,
    progress: Progress | None = None,
    velocity: FloatArray | None = None,
) -> Trajectory:
    """Run `system` over its scene's duration, from rest in `start` or from the `velocity` (n,) there.

    At rest means without any deviation from the kinematic motion: the shafts turn with the drive.
    """
    began = clock.perf_counter()
    scene = system.scene
    ladder = _ladder(integration)
    work = make_workspace(system.arrays, ladder, start.displacement, integration.fixed_step or FIRST_STEP)
    control = _control(system, integration)
    if velocity is not None:
        work.v[:] = velocity
    rate = scene.outputs.sample_rate
    samples = int(np.floor(scene.duration * rate * (1.0 + 1e-12))) + 1
    q, v = np.zeros((samples, start.displacement.size)), np.zeros((samples, start.displacement.size))
    moved = np.zeros((samples, work.moved.size), dtype=np.int64)
    initial = stored_energy(system.arrays, 0.0, start.displacement, work.v, work.moved)
    status = RunStatus.COMPLETED
    for chunk in range(1, CHUNKS + 1):
        stop = scene.duration * chunk / CHUNKS
        status = RunStatus(advance(system.arrays, work, control, stop, rate, q, v, moved))
        if progress is not None:
            progress(min(float(work.time[0]) / max(scene.duration, 1e-300), 1.0), "time integration")
        if not status.usable:
            break
    reached = int(work.counts[Count.OUTPUT])
    return Trajectory(
        status,
        np.arange(reached) / rate,
        q[:reached],
        v[:reached],
        moved[:reached],
        float(work.time[0]),
        np.array([initial, stored_energy(system.arrays, float(work.time[0]), work.q, work.v, work.moved)]),
        work.work,
        work.counts,
        _step_range(work),
        clock.perf_counter() - began,
    )


def _ladder(integration: Integration) -> FloatArray:
    """Step sizes: a ladder, or the one fixed step."""
    if integration.fixed_step is not None:
        return np.array([integration.fixed_step, 0.0])
    return step_ladder(integration.largest_step, integration.smallest_step)


def _control(system: System, integration: Integration) -> Control:
    """Make the settings for the compiled loop."""
    implicit = integration.method == "implicit"
    tolerance = STEP_SHARE * integration.tolerance
    stiffness = float(np.max(system.flanks.mean_stiffness, initial=1.0))
    return Control(
        implicit,
        integration.fixed_step is None,
        system.scene.outputs.energy_audit,
        IMPLICIT_EMBEDDED_ORDER if implicit else EXPLICIT_EMBEDDED_ORDER,
        tolerance,
        NEWTON_SHARE * tolerance * stiffness,
        integration.step_limit,
    )


def _step_range(work: Workspace) -> FloatArray:
    """Smallest and largest accepted step; zeros without one."""
    if work.counts[Count.ACCEPTED] == 0:
        return np.zeros(2)
    return np.array(
        [work.ladder[work.counts[Count.LARGEST_RUNG]], work.ladder[work.counts[Count.SMALLEST_RUNG]]]
    )
