"""Compiled march over given steps, without error control; steps in which flanks part are halved."""

from __future__ import annotations

import math

from dynamics.arrays.arrays import SystemArrays
from dynamics.integrators.explicit_step import accelerate, explicit_step
from dynamics.integrators.implicit_step import implicit_step
from dynamics.integrators.workspace import Workspace
from dynamics.kernels.compiled import compiled, inner
from dynamics.types import BoolArray, FloatArray, IntArray

HALVINGS = 8
"""A step in which a flank lifts off or lands is halved down to 1/256 around it, so that its kink costs no
digits and the end of the march depends smoothly on its start."""


@compiled
def march(
    system: SystemArrays,
    work: Workspace,
    implicit: bool,
    force_tolerance: float,
    time: FloatArray,
    level: IntArray,
    touching: BoolArray,
    keep: bool,
    path: FloatArray,
) -> bool:
    """Step from the state in `work` over `time` (N + 1,) by `level` (N,); leave the end in `work`.

    Step `level` halved j times is `step_sizes[(HALVINGS + 1) level + j]`. `touching` (R,) is scratch.
    With `keep`, q, q' and q'' at all times go into `path` (3, N + 1, n). Returns whether all stages were
    solved and the end is finite.
    """
    for i in range(work.q.size):
        work.q_new[i], work.v_new[i] = work.q[i], work.v[i]
    accelerate(system, work, time[0], 0)
    for i in range(work.q.size):
        work.a[i] = work.stage_a[0, i]
    for r in range(touching.size):
        touching[r] = work.local.elastic[r] > 0.0
    for step in range(level.size):
        if keep:
            _keep(work, step, path)
        if not _whole_step(
            system, work, implicit, force_tolerance, time[step], level[step] * (HALVINGS + 1), touching
        ):
            return False
    if keep:
        _keep(work, level.size, path)
    total = 0.0
    for i in range(work.q.size):
        total += abs(work.q[i]) + abs(work.v[i])
    return math.isfinite(total)


@inner
def _whole_step(
    system: SystemArrays,
    work: Workspace,
    implicit: bool,
    force_tolerance: float,
    start: float,
    level: int,
    touching: BoolArray,
) -> bool:
    """Advance by the step `level` in one, or in halves of halves around a change of contact."""
    parts, done, halved = 2**HALVINGS, 0, 0
    while done < parts:
        work.time[0] = start + work.step_sizes[level] * (done / parts)
        solved = True
        if implicit:
            solved = implicit_step(system, work, level + halved, force_tolerance, False)
        else:
            explicit_step(system, work, level + halved, False)
        changed = not solved
        for r in range(touching.size):
            changed = changed or (work.local.elastic[r] > 0.0) != touching[r]
        if changed and halved < HALVINGS:
            halved += 1
            continue
        if not solved:
            return False
        for i in range(work.q.size):
            work.q[i], work.v[i], work.a[i] = work.q_new[i], work.v_new[i], work.a_new[i]
        for r in range(touching.size):
            touching[r] = work.local.elastic[r] > 0.0
        done += 2 ** (HALVINGS - halved)
        while halved > 0 and done % 2 ** (HALVINGS - halved + 1) == 0:
            halved -= 1
    return True


@inner
def _keep(work: Workspace, step: int, path: FloatArray) -> None:
    for i in range(work.q.size):
        path[0, step, i], path[1, step, i], path[2, step, i] = work.q[i], work.v[i], work.a[i]
