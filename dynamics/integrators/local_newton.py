"""Newton's method for the local forces of one implicit stage, compiled."""

from __future__ import annotations

import math

from dynamics.arrays.arrays import SystemArrays
from dynamics.forces.elements import evaluate, is_linear
from dynamics.integrators.linear_elimination import gauss_jordan
from dynamics.integrators.workspace import Workspace
from dynamics.kernels.compiled import inner

ITERATION_LIMIT = 25  # most Newton iterations of a stage


WEAK = 0.01
"""Change of a row's law with its own force, below which Newton's matrix leaves the row out."""


SLOW = 0.1
"""Ratio of an update to the one before, above which Newton's matrix is computed anew."""


ROUNDING = 2.0**-52
"""Update over the largest force that is rounding wherever coordinates are as small as deflections."""


NOISE, STALL = 1e-10, 0.5
"""Bounds of an update that is rounding of larger coordinates.

It is at most NOISE times the largest force, and at least STALL times the update before.
"""


@inner
def solve_local_forces(
    system: SystemArrays, work: Workspace, level: int, span: float, tolerance: float, first: bool
) -> int:
    """Find ``work.force`` such that each force is its law's at the motion it causes; return the iterations.

    On entry ``work.free``, ``free_rate`` and ``free_position`` hold the motion without local forces, and
    ``work.force`` is a first guess; on exit ``work.local`` holds the motion with them. `first` says whether
    this is the first stage of its step. The change of the positions with the forces is followed but left out
    of the equations: it is of the order of a deflection over a base pitch. Forces of linear elements are
    part of the motion (`hold_linear`). `left` is the ratio of an update to the one before; the error after an
    update is estimated by that ratio times the update. Returns -1 if it fell neither to `tolerance` (N) nor
    to rounding.
    """
    fresh, last, left = first, math.inf, 1.0
    if first:  # later stages begin with the forces and the answer to them that the one before ended with
        _respond(work, level)
    for iteration in range(ITERATION_LIMIT):
        _move(work, span)
        for e in range(system.elements.law.size):
            if not is_linear(system.elements, e):
                evaluate(system.elements, work.local, e)
        if fresh:
            _invert_equations(system, work, level, span)
        size = _update_forces(work)
        _respond(work, level)
        if iteration > 0:
            left = size / last
        if min(left, 1.0) * size <= tolerance or _is_rounding(work, size, left):
            _move(work, span)
            return iteration + 1
        fresh = iteration > 0 and not left <= SLOW  # also where `left` is NaN
        last = size
    return -1


@inner
def _is_rounding(work: Workspace, size: float, left: float) -> bool:
    """Whether an update, of which the part `left` remains, is all that rounding lets Newton's method do."""
    largest = 0.0
    for r in range(work.force.size):
        largest = max(largest, abs(work.force[r]))
    return size <= ROUNDING * largest or (left >= STALL and size <= NOISE * largest)


@inner
def _respond(work: Workspace, level: int) -> None:
    """Write the accelerations of coordinates and positions by the forces, approach f, into ``response``."""
    response = work.response
    for k in range(response.size):
        response[k] = 0.0
    for r in range(work.force.size):
        force = work.force[r]
        if force != 0.0:
            for k in range(response.size):
                response[k] += work.approach[level, r, k] * force


@inner
def _move(work: Workspace, span: float) -> None:
    """Let the forces move coordinates and positions by -span^2 response, and rates by -span response."""
    response, local, rows = work.response, work.local, work.force.size
    for k in range(rows):
        local.coordinate[k] = work.free[k] - span * span * response[k]
        local.rate[k] = work.free_rate[k] - span * response[k]
        local.acceleration[k] = work.free_acceleration[k] - response[k]
    for m in range(work.free_position.size):
        local.position[m] = work.free_position[m] - span * span * response[rows + m]


@inner
def _gain(work: Workspace, span: float, k: int, j: int) -> float:
    """Return the derivative of the law of row k in the force that moves coordinate j of the same element."""
    slope = span * (span * work.local.tangent[k, j] + work.local.viscous[k, j])
    return float(slope + work.local.inertial[k, j])


@inner
def _invert_equations(system: SystemArrays, work: Workspace, level: int, span: float) -> None:
    """List the rows whose law changes by more than WEAK with their own force, and invert their equations.

    These are I + (span^2 df/dy + span df/dy' + df/dy'') approach, transposed: then columns of the inverse lie
    along rows in memory.
    """
    size, approach = 0, work.approach
    for e in range(system.elements.law.size):
        first, end = system.elements.first[e], system.elements.first[e + 1]
        for k in range(first, end):
            change = 0.0
            for j in range(end - first):
                change += abs(_gain(work, span, k, j)) * approach[level, first + j, first + j]
            if change > WEAK:
                work.solved[size] = k
                size += 1
    work.solved[size] = -1  # the end of the list
    for e in range(system.elements.law.size):
        first, end = system.elements.first[e], system.elements.first[e + 1]
        for b in range(size):
            k = work.solved[b]
            if not first <= k < end:
                continue
            for a in range(size):
                total = 1.0 if a == b else 0.0
                for j in range(end - first):
                    total += _gain(work, span, k, j) * approach[level, first + j, work.solved[a]]
                work.jacobian[a, b] = total
                work.jacobian[a, size + b] = 1.0 if a == b else 0.0
    gauss_jordan(work.jacobian, size)


@inner
def _update_forces(work: Workspace) -> float:
    """Add the update that the equations give to ``work.force``, and return the largest one."""
    update, solved, size = work.update, work.correction, 0
    for r in range(update.size):
        update[r] = work.local.force[r] - work.force[r]
    while work.solved[size] >= 0:
        solved[size] = 0.0
        size += 1
    for b in range(size):
        value = update[work.solved[b]]
        for a in range(size):
            solved[a] += work.jacobian[b, size + a] * value
    for a in range(size):
        update[work.solved[a]] = solved[a]
    largest = 0.0
    for r in range(update.size):
        work.force[r] += update[r]
        largest = max(largest, abs(update[r]))
    return largest
