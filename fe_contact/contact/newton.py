"""Active-set Newton method for one contact point problem: who carries what.

Find the forces F >= 0 and the deflection d with

    sum_j C_ij F_j + lambda_i(F_i) + g_i - m_i d  = 0 where F_i > 0,  >= 0 where F_i = 0,
    sum_i n_i F_i = T,

C symmetric positive definite, lambda_i increasing and concave. With m = n this is the optimum of a strictly
convex energy, so there is one solution; off the line of action m and n differ by a per cent.

Bold steps come first: Newton on the contacts of the current set, from which all leave that turn negative and
which all enter that penetrate. This needs a handful of iterations but might cycle. If it has not settled
after `PATIENCE` iterations, cautious steps take over: a step ends where the first force reaches zero, and
contacts enter one by one. The law is so nearly straight that the energy then falls with every step
(docs/theory/contact.md), so that no set comes back.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from fe_contact.contact.cholesky import dot, factorize, substitute
from fe_contact.contact.local_law import LocalLaw, approach
from fe_contact.types import BoolArray, FloatArray, IntArray

CONVERGED, ITERATION_LIMIT, SINGULAR, OUT_OF_MODEL = 0, 1, 2, 3
"""The values of `fe_contact.types.Status` that this solver gives."""

MAX_ITERATIONS = 300
STEP_TOLERANCE = 1e-10
"""Largest last change of a force over the load; Newton squares it, so the forces are good to rounding."""
PATIENCE = 24
"""Iterations with bold steps before cautious ones take over; none of 30 000 random problems needed them."""
_PENETRATION = 1e-12


class PointProblem(NamedTuple):
    """One position: n contacts that can carry force.

    Attributes
    ----------
    compliance : ndarray, shape (n, n)
        Normal approach at i per unit normal force at j, m/N.
    gap : ndarray, shape (n,)
        Normal rigid gap in m; infinite = no such contact.
    motion_arm, torque_arm : ndarray, shape (n,)
        Normal approach per unit deflection, and share of the load per unit force; > 0.
    law : LocalLaw
    """

    compliance: FloatArray
    gap: FloatArray
    motion_arm: FloatArray
    torque_arm: FloatArray
    law: LocalLaw


class _Workspace(NamedTuple):
    """Arrays of one solve; matrix, motion, rest and member are filled up to the size of the current set."""

    gap: FloatArray  # from the deflection at which the first contact touches
    active: BoolArray
    member: IntArray
    matrix: FloatArray
    motion: FloatArray  # force per unit deflection
    rest: FloatArray  # change of force at zero deflection


@njit(cache=True)
def solve_point(
    problem: PointProblem,
    total: float,
    force: FloatArray,
    residual: FloatArray,
    patience: int = PATIENCE,
) -> tuple[float, float, int, int, bool]:
    """Solve one position at one load.

    Parameters
    ----------
    problem : PointProblem
    total : float
        Right-hand side of the equilibrium in N, > 0.
    force : ndarray, shape (n,)
        In: starting forces, the positive ones are the starting set. Out: the solution.
    residual : ndarray, shape (4,)
        Out: equilibrium, penetration, tension and complementarity, relative to the load and to the elastic
        deflection.
    patience : int
        Iterations with bold steps.

    Returns
    -------
    deflection, tangent : float
        m, and its derivative in `total`, m/N.
    status, iterations : int
        `CONVERGED`, `ITERATION_LIMIT`, `SINGULAR` (no positive definite compliance, or a gap that is NaN), or
        `OUT_OF_MODEL` (no contact exists).
    beyond : bool
        Whether any contact outgrew its patch.
    """
    touch = _first_touch(problem)
    if not math.isfinite(touch):
        force[:] = 0.0
        residual[:] = math.inf
        return math.nan, math.nan, SINGULAR if math.isnan(touch) else OUT_OF_MODEL, 0, False
    work = _start(problem, touch, force)
    elastic, tangent, status, iterations = _iterate(problem, total, force, work, patience)
    if status == SINGULAR:
        residual[:] = math.inf
        return math.nan, math.nan, status, iterations, False
    beyond = _residuals(problem, total, elastic, force, work.gap, residual)
    return touch + elastic, tangent, status, iterations, beyond


@njit(cache=True)
def _first_touch(problem: PointProblem) -> float:
    """Deflection at which the first contact touches; infinite if there is none, NaN if a gap is."""
    touch = math.inf
    for i in range(problem.gap.size):
        if math.isnan(problem.gap[i]):
            return math.nan
        if math.isfinite(problem.gap[i]):
            touch = min(touch, problem.gap[i] / problem.motion_arm[i])
    return touch


@njit(cache=True)
def _start(problem: PointProblem, touch: float, force: FloatArray) -> _Workspace:
    """Take the loaded contacts as the first set, or the one that touches first."""
    n = problem.gap.size
    gap = problem.gap - problem.motion_arm * touch
    active = (force > 0.0) & np.isfinite(gap)
    force[~active] = 0.0
    if not active.any():
        active[np.argmin(gap)] = True
    member = np.empty(n, dtype=np.int64)
    return _Workspace(gap, active, member, np.empty((n, n)), np.empty(n), np.empty(n))


@njit(cache=True)
def _iterate(
    problem: PointProblem, total: float, force: FloatArray, work: _Workspace, patience: int
) -> tuple[float, float, int, int]:
    """Iterate to the solution; return elastic deflection, tangent, status and iterations."""
    elastic, tangent = math.nan, math.nan
    for iteration in range(1, MAX_ITERATIONS + 1):
        bold = iteration <= patience
        if not bold:
            _rescale(problem, total, force, work)
        size = _newton_system(problem, force, work)
        if not factorize(work.matrix, size):
            return math.nan, math.nan, SINGULAR, iteration
        substitute(work.matrix, work.motion, size)
        substitute(work.matrix, work.rest, size)
        stiffness, carried = 0.0, 0.0
        for r in range(size):
            i = work.member[r]
            stiffness += problem.torque_arm[i] * work.motion[r]
            carried += problem.torque_arm[i] * (force[i] + work.rest[r])
        tangent = 1.0 / stiffness
        elastic = (total - carried) * tangent
        step = _bold_step(size, elastic, force, work) if bold else _cautious_step(size, elastic, force, work)
        settled = step <= STEP_TOLERANCE * total
        entered = (settled or (bold and math.isfinite(step))) and _enter(problem, elastic, force, work, bold)
        if settled and not entered:
            return elastic, tangent, CONVERGED, iteration
    return elastic, tangent, ITERATION_LIMIT, MAX_ITERATIONS


@njit(cache=True)
def _newton_system(problem: PointProblem, force: FloatArray, work: _Workspace) -> int:
    """Fill matrix and right-hand sides of the current set; return its size."""
    size = 0
    for i in range(force.size):
        if work.active[i]:
            work.member[size] = i
            size += 1
    for r in range(size):
        i = work.member[r]
        row = problem.compliance[i]
        value, slope, _ = approach(problem.law, i, force[i])
        work.motion[r] = problem.motion_arm[i]
        work.rest[r] = -(work.gap[i] + value + dot(row, force, force.size))
        for s in range(r + 1):
            work.matrix[r, s] = row[work.member[s]]
        work.matrix[r, r] += slope
    return size


@njit(cache=True)
def _bold_step(size: int, elastic: float, force: FloatArray, work: _Workspace) -> float:
    """Apply the whole Newton step; return its largest change, infinite when a contact leaves."""
    step = 0.0
    for r in range(size):
        i = work.member[r]
        change = elastic * work.motion[r] + work.rest[r]
        if force[i] + change < 0.0:
            work.active[i] = False
            force[i] = 0.0
            step = math.inf
        else:
            force[i] += change
            step = max(step, abs(change))
    return step


@njit(cache=True)
def _rescale(problem: PointProblem, total: float, force: FloatArray, work: _Workspace) -> None:
    """Put the forces into equilibrium."""
    carried = dot(problem.torque_arm, force, force.size)
    if carried > 0.0:
        force *= total / carried
    else:
        nearest = np.argmin(work.gap)
        work.active[nearest] = True
        force[nearest] = total / problem.torque_arm[nearest]


@njit(cache=True)
def _cautious_step(size: int, elastic: float, force: FloatArray, work: _Workspace) -> float:
    """Step until a force reaches zero, which then leaves; return what `_bold_step` returns."""
    change = work.motion
    length, blocking = 1.0, -1
    for r in range(size):
        change[r] = elastic * work.motion[r] + work.rest[r]
        if force[work.member[r]] + length * change[r] < 0.0:
            length, blocking = -force[work.member[r]] / change[r], r
    step = 0.0
    for r in range(size):
        force[work.member[r]] = max(force[work.member[r]] + length * change[r], 0.0)
        step = max(step, abs(length * change[r]))
    if blocking < 0:
        return step
    force[work.member[blocking]] = 0.0
    work.active[work.member[blocking]] = False
    return math.inf


@njit(cache=True)
def _enter(problem: PointProblem, elastic: float, force: FloatArray, work: _Workspace, bold: bool) -> bool:
    """Activate the contacts that penetrate; a cautious solver takes the deepest only."""
    worst, deepest = -_PENETRATION * elastic, -1
    entered = False
    for i in range(force.size):
        if work.active[i] or not math.isfinite(work.gap[i]):
            continue
        slack = work.gap[i] - problem.motion_arm[i] * elastic + dot(problem.compliance[i], force, force.size)
        if slack < -_PENETRATION * elastic:
            entered = True
            work.active[i] = bold
            if slack < worst:
                worst, deepest = slack, i
    if deepest >= 0:
        work.active[deepest] = True
    return entered


@njit(cache=True)
def _residuals(
    problem: PointProblem,
    total: float,
    elastic: float,
    force: FloatArray,
    gap: FloatArray,
    residual: FloatArray,
) -> bool:
    """Measure the four residuals of the solution, and whether any contact outgrew its patch."""
    residual[:] = 0.0
    any_beyond = False
    for i in range(force.size):
        if not math.isfinite(gap[i]):
            continue
        value, _, beyond = approach(problem.law, i, force[i])
        any_beyond = any_beyond or beyond
        moved = dot(problem.compliance[i], force, force.size) + value
        slack = (gap[i] - problem.motion_arm[i] * elastic + moved) / elastic
        residual[1] = max(residual[1], -slack)
        residual[2] = max(residual[2], -force[i] / total)
        residual[3] = max(residual[3], abs(force[i] * slack) / total)
    residual[0] = abs(dot(problem.torque_arm, force, force.size) - total) / total
    return any_beyond
