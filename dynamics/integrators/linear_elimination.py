"""Compiled elimination of linear force elements from the implicit stages.

A local force accelerates all local coordinates and positions by W, which ``approach`` holds for each step
size (`level`). Over the span s of a stage (step times diagonal coefficient) the linear elements, with
stiffness K and damping C, answer a local acceleration with B = s^2 K + s C. H is the inverse of I + B W in
their rows: ``linear`` lists these rows, in columns the row, and the first and the end, in the list, of its
element.
"""

from __future__ import annotations

from dynamics.arrays.arrays import SystemArrays
from dynamics.forces.elements import evaluate_linear, has_unbalance, is_linear
from dynamics.integrators.workspace import Workspace
from dynamics.kernels.compiled import inner, inner_sums
from dynamics.types import FloatArray


@inner
def gauss_jordan(matrix: FloatArray, size: int) -> None:
    """Turn [A, I] in the first `size` rows into [I, inverse], with row pivoting (Gauss and Jordan)."""
    for p in range(size):
        largest = p
        for i in range(p + 1, size):
            if abs(matrix[i, p]) > abs(matrix[largest, p]):
                largest = i
        pivot = 1.0 / matrix[largest, p]
        for j in range(2 * size):  # exchange both rows, and scale the one with the pivot
            matrix[largest, j], matrix[p, j] = matrix[p, j], matrix[largest, j] * pivot
        for i in range(size):
            factor = matrix[i, p]
            if i != p and factor != 0.0:
                for j in range(2 * size):
                    matrix[i, j] -= factor * matrix[p, j]


@inner
def eliminate_linear(system: SystemArrays, work: Workspace, level: int, span: float) -> None:
    """Fill ``linear_response`` of a level, and let linear elements follow in its ``approach``."""
    if work.linear.shape[0] == 0:
        return
    for e in range(system.elements.law.size):
        if is_linear(system.elements, e):
            evaluate_linear(system.elements, work.local, e)
    _invert(work, level, span)
    _hold(work, level)
    _follow(work, level, span)


@inner
def _invert(work: Workspace, level: int, span: float) -> None:
    """Write H behind I + B W in ``jacobian``."""
    count = work.linear.shape[0]
    for a in range(count):
        for b in range(count):
            unit = 1.0 if a == b else 0.0
            work.jacobian[a, b] = unit + _strain(work, level, span, a, work.linear[b, 0])
            work.jacobian[a, count + b] = unit
    gauss_jordan(work.jacobian, count)


@inner
def _strain(work: Workspace, level: int, span: float, a: int, row: int) -> float:
    """Return the entry of B W in the linear row number `a` for a force in `row`."""
    local, total = work.local, 0.0
    element, first, end = work.linear[a, 0], work.linear[a, 1], work.linear[a, 2]
    for c in range(first, end):
        gain = span * (span * local.tangent[element, c - first] + local.viscous[element, c - first])
        total += gain * work.approach[level, row, work.linear[c, 0]]
    return total


@inner
def _hold(work: Workspace, level: int) -> None:
    """Write the accelerations W H K and W H C by the linear elements."""
    count = work.linear.shape[0]
    for c in range(count):
        for k in range(work.response.size):
            work.linear_response[level, k, c] = work.linear_response[level, k, count + c] = 0.0
        first, end = work.linear[c, 1], work.linear[c, 2]
        for b in range(count):
            spring, damper = 0.0, 0.0
            for a in range(first, end):
                row, weight = work.linear[a, 0], work.jacobian[b, count + a]
                spring += weight * work.local.tangent[row, c - first]
                damper += weight * work.local.viscous[row, c - first]
            for k in range(work.response.size):
                answer = work.approach[level, work.linear[b, 0], k]
                work.linear_response[level, k, c] += spring * answer
                work.linear_response[level, k, count + c] += damper * answer


@inner
def _follow(work: Workspace, level: int, span: float) -> None:
    """Subtract W H B W from the answer to each other force; the rows of linear elements become 0."""
    count = work.linear.shape[0]
    for row in range(work.force.size):
        if _is_linear_row(work, row):
            continue
        for a in range(count):
            work.resting[a] = _strain(work, level, span, a, row)  # as scratch
        for b in range(count):
            force = 0.0
            for a in range(count):
                force += work.jacobian[b, count + a] * work.resting[a]
            for k in range(work.response.size):
                work.approach[level, row, k] -= force * work.approach[level, work.linear[b, 0], k]
    for b in range(count):
        for k in range(work.response.size):
            work.approach[level, work.linear[b, 0], k] = 0.0


@inner
def _is_linear_row(work: Workspace, row: int) -> bool:
    is_listed = False
    for a in range(work.linear.shape[0]):
        is_listed = is_listed or work.linear[a, 0] == row
    return bool(is_listed)


@inner
def apply_linear(work: Workspace) -> None:
    """Write the forces of linear elements in the local state at the end of a stage; tangents are constant."""
    local = work.local
    for a in range(work.linear.shape[0]):
        row, first, end = work.linear[a, 0], work.linear[a, 1], work.linear[a, 2]
        elastic, viscous = 0.0, 0.0
        for c in range(first, end):
            elastic += local.tangent[row, c - first] * local.coordinate[work.linear[c, 0]]
            viscous += local.viscous[row, c - first] * local.rate[work.linear[c, 0]]
        local.elastic[row] = elastic
        work.force[row] = local.force[row] = elastic + viscous


@inner
def hold_linear(system: SystemArrays, work: Workspace, level: int, span: float) -> None:
    """Let linear elements act on the motion without local forces; Newton's method leaves their rows at 0."""
    count = work.linear.shape[0]
    if count == 0:
        return
    for c in range(count):
        row = work.linear[c, 0]
        work.resting[c], work.resting[count + c] = work.free[row], work.free_rate[row]
        work.force[row] = work.local.force[row] = 0.0
    rows, accelerated = work.force.size, has_unbalance(system.elements)
    for k in range(rows):
        answer = _sum(work.linear_response[level, k], work.resting)
        work.free[k] -= span * span * answer
        work.free_rate[k] -= span * answer
        if accelerated:
            work.free_acceleration[k] -= answer
    for m in range(work.free_position.size):
        work.free_position[m] -= span * span * _sum(work.linear_response[level, rows + m], work.resting)


@inner_sums
def _sum(weights: FloatArray, values: FloatArray) -> float:
    total = 0.0
    for c in range(values.size):
        total += weights[c] * values[c]
    return total
