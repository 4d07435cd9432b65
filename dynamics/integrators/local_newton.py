"""Compiled Newton's method for the local forces of one implicit stage.

Everything but the elements is linear, and each acts along its few constant directions, so the stage's n
equations reduce to one scalar unknown per row: its local force.
"""

from __future__ import annotations

from dynamics.arrays.arrays import SystemArrays
from dynamics.forces.compiled import inner
from dynamics.forces.element_laws import evaluate
from dynamics.integrators.workspace import Workspace
from dynamics.types import FloatArray

ITERATION_LIMIT = 25


@inner
def solve_local_forces(
    system: SystemArrays, work: Workspace, level: int, span: float, tolerance: float
) -> int:
    """Find ``work.force`` such that each force is its law's at the motion it causes; return the iterations.

    On entry ``work.free``, ``free_rate`` and ``free_position`` hold the motion without local forces, and
    ``work.force`` is a first guess; on exit ``work.local`` holds the motion with them. The change of the
    positions with the forces is followed but left out of the Jacobian: it is of the order of a deflection
    over a base pitch. Returns -1 if the last update was not below `tolerance` (N).
    """
    elements = system.elements
    for iteration in range(ITERATION_LIMIT):
        for m in range(work.free_position.size):
            _move_position(work, level, span, m)
        for e in range(elements.law.size):
            first, end = elements.first[e], elements.first[e + 1]
            for k in range(first, end):
                _move_row(work, level, span, k)
            evaluate(elements, work.local, e)
            _linearize(work, level, span, first, end)
        if update_forces(work.jacobian, work.force) <= tolerance:
            _settle(work, level, span)
            return iteration + 1
    return -1


@inner
def _settle(work: Workspace, level: int, span: float) -> None:
    """Let the forces found act on all coordinates, rates and positions."""
    for m in range(work.free_position.size):
        _move_position(work, level, span, m)
    for k in range(work.force.size):
        _move_row(work, level, span, k)


@inner
def _move_row(work: Workspace, level: int, span: float, k: int) -> None:
    """Let the forces act: force r changes coordinate k by -span^2 approach[k, r], its rate by -span ..."""
    moved = 0.0
    for r in range(work.force.size):
        moved += work.approach[level, k, r] * work.force[r]
    work.local.coordinate[k] = work.free[k] - span * span * moved
    work.local.rate[k] = work.free_rate[k] - span * moved


@inner
def _move_position(work: Workspace, level: int, span: float, m: int) -> None:
    """Let the forces turn the driver of mesh m."""
    turned = 0.0
    for r in range(work.force.size):
        turned += work.position_response[level, m, r] * work.force[r]
    work.local.position[m] = work.free_position[m] - span * span * turned


@inner
def _linearize(work: Workspace, level: int, span: float, first: int, end: int) -> None:
    """Write the equations of one element's rows: I + (span^2 df/dy + span df/dy') approach | law - force."""
    rows, local = work.force.size, work.local
    if end - first == 1:  # most elements: no sum over an element's own coordinates
        gain = span * (span * local.tangent[first, 0] + local.viscous[first, 0])
        for r in range(rows):
            work.jacobian[first, r] = gain * work.approach[level, first, r]
    else:
        _chain(work, level, span, first, end)
    for k in range(first, end):
        work.jacobian[k, k] += 1.0
        work.jacobian[k, rows] = local.force[k] - work.force[k]


@inner
def _chain(work: Workspace, level: int, span: float, first: int, end: int) -> None:
    """Write (span^2 df/dy + span df/dy') approach for an element of several rows."""
    for k in range(first, end):
        for r in range(work.force.size):
            total = 0.0
            for j in range(end - first):
                gain = span * (span * work.local.tangent[k, j] + work.local.viscous[k, j])
                total += gain * work.approach[level, first + j, r]
            work.jacobian[k, r] = total


@inner
def update_forces(jacobian: FloatArray, force: FloatArray) -> float:
    """Solve the augmented system (R, R + 1) with row pivoting, add to `force`, return the largest update."""
    size, largest = force.size, 0.0
    for p in range(size):
        best = p
        for i in range(p + 1, size):
            if abs(jacobian[i, p]) > abs(jacobian[best, p]):
                best = i
        for j in range(p, size + 1):
            jacobian[p, j], jacobian[best, j] = jacobian[best, j], jacobian[p, j]
        for i in range(p + 1, size):
            factor = jacobian[i, p] / jacobian[p, p]
            if factor == 0.0:  # an element out of contact: its row is that of the identity
                continue
            for j in range(p + 1, size + 1):
                jacobian[i, j] -= factor * jacobian[p, j]
    for p in range(size - 1, -1, -1):
        for j in range(p + 1, size):
            jacobian[p, size] -= jacobian[p, j] * jacobian[j, size]
        jacobian[p, size] /= jacobian[p, p]
        force[p] += jacobian[p, size]
        largest = max(largest, abs(jacobian[p, size]))
    return largest
