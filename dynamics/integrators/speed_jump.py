"""Compiled steps that end where a speed law has a knot: the inertia of the kinematic motion jumps there.

The last of the step sizes, the landing level, is for steps that end at a knot.
"""

from __future__ import annotations

import math

from dynamics.arrays.arrays import SystemArrays
from dynamics.integrators.workspace import Workspace
from dynamics.kernels.compiled import inner
from dynamics.kernels.cubics import Cubics, piece_at

ROUNDING = 4.0 * 2.0**-52
"""Part of a knot's time by which a step ends before it: its last stage still sees the law's old piece."""


SMOOTH = 1e-9
"""Jump of an acceleration over the acceleration by the law's pieces, below which it is rounding."""


@inner
def next_jump(laws: Cubics, time: float) -> float:
    """Return when the next piece of any law begins if the slope jumps there; infinite if none does."""
    nearest = math.inf
    for k in range(laws.first.size - 1):
        piece = piece_at(laws, k, time)
        if piece + 1 < laws.first[k + 1]:  # the law has a further piece
            start, c = laws.start[piece + 1], laws.coefficient
            s = start - laws.start[piece]
            before = c[piece, 1] + s * (2.0 * c[piece, 2] + 3.0 * s * c[piece, 3])
            size = abs(c[piece, 1]) + abs(before) + abs(c[piece + 1, 1])
            if abs(c[piece + 1, 1] - before) > SMOOTH * size:
                nearest = min(nearest, start)
    return nearest


@inner
def step_to_jump(system: SystemArrays, work: Workspace, level: int, jump: float) -> int:
    """Return the landing level, made to end at `jump`, if the step of `level` would pass it; else `level`."""
    step = jump * (1.0 - ROUNDING) - work.time[0]
    if not 0.0 < step <= work.step_sizes[level]:
        return level
    landing = int(work.step_sizes.size - 1)
    work.step_sizes[landing] = step
    work.ready[landing] = False
    return landing
