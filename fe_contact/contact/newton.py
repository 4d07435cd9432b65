"""Newton's method for one contact point problem: who carries what.

m contacts press on n slices of the bodies by the parts N (m, n) of their forces. Find the forces on the
slices h (n,) and the deflection d with

    h = N'F,    F_q = phi_q(m_q d - g_q - (N K h)_q) >= 0,    sum_q n_q F_q = T,

K the compliance of the bodies and phi_q, the inverse of the local approach, convex and zero where flanks
part. Which contacts carry needs no search: each follows from its own approach. With D the slopes of phi,
Newton's matrix is 1 + N'DN K, and only the slices of pairs that touch have rows in it. With m = n this is
the search for the least energy

    h'K h/2 + sum_q Phi_q(m_q d - g_q - (N K h)_q) - T d;

off the line of action m and n differ by a per cent. A whole step may go too far where contacts enter; it is
then cut to where the energy along it is least (docs/theory/contact.md).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.contact.point_problem import (
    PointProblem,
    State,
    approach,
    dot,
    eliminate,
    evaluate,
    motion_at,
    move,
    press,
    stiffness,
)
from fe_contact.types import FloatArray, IntArray
from host.loops import njit

CONVERGED, ITERATION_LIMIT, SINGULAR, OUT_OF_MODEL = 0, 1, 2, 3
"""The values of `fe_contact.types.Status` that this solver gives."""

MAX_ITERATIONS = 100
STEP_TOLERANCE = 1e-11
"""Largest last change of the motions over the deflection; Newton squares it, so they are good to rounding."""
ROUNDING = 1e-7
"""The same, below which steps that do not fall any more are rounding: of bodies that turn by much."""
_CUTS = 30
_LEVEL = 0.3
"""Slope of the energy at the end of a step over its fall at the beginning, from which on the step is cut."""


class NewtonSystem(NamedTuple):
    """Newton's equations of the slices of touching pairs; filled up to their number.

    Attributes
    ----------
    member : ndarray of int, shape (n,)
        Those slices.
    touching : ndarray, shape (n, n)
        N'DN of all slices, N/m.
    matrix : ndarray, shape (n, n)
        1 + N'DN K.
    right : ndarray, shape (2, n)
        N'D m in N/m, and what the forces on the slices miss in N.
    shares : ndarray, shape (n,)
        N'D n of all slices, N/m.
    left : ndarray, shape (n,)
        Forces on slices of pairs that do not touch any more, N.
    """

    member: IntArray
    touching: FloatArray
    matrix: FloatArray
    right: FloatArray
    shares: FloatArray
    left: FloatArray


@njit(cache=True, error_model="numpy")
def empty_system(n: int) -> NewtonSystem:
    """Return room for the equations of so many slices."""
    member, square = np.empty(n, dtype=np.int64), np.empty((2, n, n))
    return NewtonSystem(member, square[0], square[1], np.empty((2, n)), np.empty(n), np.empty(n))


@njit(cache=True, error_model="numpy")
def solve_point(
    problem: PointProblem, total: float, force: FloatArray, residual: FloatArray
) -> tuple[float, float, int, int, bool]:
    """Solve one position at one load.

    Parameters
    ----------
    total : float
        Right-hand side of the equilibrium in N, > 0.
    force : ndarray, shape (m,)
        In: starting forces, or zeros. Out: the solution.
    residual : ndarray, shape (4,)
        Out: equilibrium, penetration, tension and complementarity, relative to the load and to the elastic
        deflection.

    Returns
    -------
    deflection, tangent : float
        m, and its derivative in `total`, m/N.
    status, iterations : int
        `CONVERGED`, `ITERATION_LIMIT`, `SINGULAR` (a compliance or a gap that is not finite, or no unique
        step), or `OUT_OF_MODEL` (no contact exists).
    beyond : bool
        Whether the strip of any contact outgrew the reference length.
    """
    residual[:] = math.inf
    if force.size == 0:
        return math.nan, math.nan, OUT_OF_MODEL, 0, False
    touch = np.min(problem.gap / problem.motion_arm)
    gap = problem.gap - problem.motion_arm * touch  # from where the first contact touches
    m, n = force.size, problem.bodies.shape[0]
    if math.isnan(touch) or not 0.0 < np.trace(problem.bodies) < math.inf:
        force[:] = 0.0
        return math.nan, math.nan, SINGULAR, 0, False
    state = State(np.zeros(n), np.zeros(n), force, np.zeros(m), np.zeros(n))
    elastic = _start(problem, total, gap, state)
    elastic, tangent, status, iterations = _iterate(problem, total, gap, elastic, state)
    if status == SINGULAR:
        return math.nan, math.nan, status, iterations, False
    beyond = _residuals(problem, total, elastic, gap, state, residual)
    return touch + elastic, tangent, status, iterations, beyond


@njit(cache=True, error_model="numpy")
def _start(problem: PointProblem, total: float, gap: FloatArray, state: State) -> float:
    """Fill the state by the given forces, or a guess of them; return the elastic deflection they ask for."""
    state.force[:] = np.maximum(state.force, 0.0)
    if not state.force.any():
        _guess(problem, total, gap, state.force)
    press(problem, state.force, state.held)
    move(problem, state.held, state.moved)
    needed, arm = 0.0, 0.0
    for q in range(gap.size):
        if state.force[q] > 0.0:
            value, _, _ = approach(problem.law, problem.place[q], state.force[q])
            needed += state.force[q] * (gap[q] + value + motion_at(problem, q, state.moved))
            arm += state.force[q] * problem.motion_arm[q]
    elastic = needed / arm
    evaluate(problem, gap, elastic, state)
    return float(elastic)


@njit(cache=True, error_model="numpy")
def _guess(problem: PointProblem, total: float, gap: FloatArray, force: FloatArray) -> None:
    """Fill in forces as the gaps would take them if all slices gave way alike."""
    depth = total * np.trace(problem.bodies) / problem.bodies.shape[0]
    carried = 0.0
    for q in range(gap.size):
        force[q] = max(depth - gap[q], 0.0) * problem.law.width[problem.place[q]]
        carried += problem.torque_arm[q] * force[q]
    force *= total / carried


@njit(cache=True, error_model="numpy")
def _iterate(
    problem: PointProblem, total: float, gap: FloatArray, elastic: float, state: State
) -> tuple[float, float, int, int]:
    """Iterate to the solution; return elastic deflection, tangent, status and iterations."""
    n = state.held.size
    system = empty_system(n)
    change, motion = np.empty((2, n))
    tangent, last = math.nan, math.inf
    for iteration in range(1, MAX_ITERATIONS + 1):
        if not state.slope.any():  # a step too far has parted all flanks
            elastic = _start(problem, total, gap, state)
        size = newton_system(problem, state, system)
        if not eliminate(system.matrix, system.right, size):
            return math.nan, math.nan, SINGULAR, iteration
        excess = dot(problem.torque_arm, state.force, gap.size) - total
        stiff, missed = _condensed(problem, state, system, size)
        if not 0.0 < stiff < math.inf:
            return math.nan, math.nan, SINGULAR, iteration
        tangent = 1.0 / stiff
        step = -(excess + missed) * tangent
        change[:] = state.pressed - state.held  # of pairs that do not touch: their forces go
        for r in range(size):
            change[system.member[r]] = step * system.right[0, r] + system.right[1, r]
        move(problem, change, motion)
        elastic = _advance(problem, total, gap, elastic, step, change, motion, state)
        before, last = last, max(abs(step), np.abs(motion).max())
        rounding = before <= ROUNDING * elastic and last > 0.1 * before
        if last <= STEP_TOLERANCE * elastic or rounding:
            return elastic, tangent, CONVERGED, iteration
    return elastic, tangent, ITERATION_LIMIT, MAX_ITERATIONS


@njit(cache=True, error_model="numpy")
def _condensed(problem: PointProblem, state: State, system: NewtonSystem, size: int) -> tuple[float, float]:
    """Return the stiffness of the position in N/m, and what the slices miss of the load in N."""
    stiff, missed = stiffness(problem, state), 0.0
    for r in range(state.held.size):
        if system.shares[r] != 0.0:
            for s in range(size):
                yielding = system.shares[r] * problem.bodies[r, system.member[s]]
                stiff -= yielding * system.right[0, s]
                missed -= yielding * system.right[1, s]
            missed += system.shares[r] * dot(problem.bodies[r], system.left, system.left.size)
    return stiff, missed


@njit(cache=True, error_model="numpy")
def _advance(
    problem: PointProblem,
    total: float,
    gap: FloatArray,
    elastic: float,
    step: float,
    change: FloatArray,
    motion: FloatArray,
    state: State,
) -> float:
    """Take a step, or the part of it to where the energy is level; return the elastic deflection."""
    held, moved, before = state.held.copy(), state.moved.copy(), elastic
    fall = (dot(problem.torque_arm, state.force, gap.size) - total) * step
    fall += dot(motion, state.held - state.pressed, motion.size)
    low, high, at_low, at_high, length = 0.0, math.inf, fall, math.inf, 1.0
    for _ in range(_CUTS):
        elastic = before + length * step
        state.held[:] = held + length * change
        state.moved[:] = moved + length * motion
        evaluate(problem, gap, elastic, state)
        rise = (dot(problem.torque_arm, state.force, gap.size) - total) * step
        rise += dot(motion, state.held - state.pressed, motion.size)
        if not fall < 0.0 or abs(rise) <= -_LEVEL * fall or (rise < 0.0 and high == math.inf):
            break
        if rise > 0.0:
            high, at_high = length, rise
        else:
            low, at_low = length, rise
        length = low + min(max(at_low / (at_low - at_high), 0.1), 0.9) * (high - low)
    move(problem, state.held, state.moved)  # as they are, after many steps too
    return elastic


@njit(cache=True, error_model="numpy")
def newton_system(problem: PointProblem, state: State, system: NewtonSystem) -> int:
    """Fill in Newton's equations; return the number of slices of pairs that touch."""
    count = problem.blend.shape[1]
    motion = np.zeros(state.held.size)
    _touching(problem, state, system, motion)
    size, left = 0, system.left
    left[:] = 0.0
    for j in range(0, state.held.size, count):
        carries = 0.0
        for k in range(j, j + count):
            carries += system.touching[k, k]
        if carries > 0.0:
            for k in range(j, j + count):
                system.member[size] = k
                size += 1
        else:
            left[j : j + count] = state.held[j : j + count] - state.pressed[j : j + count]
    any_left = left.any()
    for r in range(size):
        i = system.member[r]
        first = i // count * count
        system.right[0, r], system.right[1, r] = motion[i], state.pressed[i] - state.held[i]
        system.matrix[r, :size] = 0.0
        for j in range(first, first + count):
            part = system.touching[max(i, j), min(i, j)]
            for s in range(0, size, count):
                block = system.member[s]
                for b in range(count):
                    system.matrix[r, s + b] += part * problem.bodies[j, block + b]
            if any_left:
                system.right[1, r] += part * dot(problem.bodies[j], left, left.size)
        system.matrix[r, r] += 1.0
    return size


@njit(cache=True, error_model="numpy")
def _touching(problem: PointProblem, state: State, system: NewtonSystem, motion: FloatArray) -> None:
    """Fill in the lower triangle of N'DN, N'D m and N'D n of all slices."""
    points, count = problem.blend.shape
    touching, shares = system.touching, system.shares
    touching[:], shares[:] = 0.0, 0.0
    for q in range(state.force.size):
        slope = state.slope[q]
        if slope != 0.0:
            first, row = problem.place[q] // points * count, problem.place[q] % points
            for a in range(count):
                part = slope * problem.blend[row, a]
                motion[first + a] += part * problem.motion_arm[q]
                shares[first + a] += part * problem.torque_arm[q]
                for b in range(a + 1):
                    touching[first + a, first + b] += part * problem.blend[row, b]


@njit(cache=True, error_model="numpy")
def _residuals(
    problem: PointProblem,
    total: float,
    elastic: float,
    gap: FloatArray,
    state: State,
    residual: FloatArray,
) -> bool:
    """Measure the four residuals of the forces found, and whether any strip outgrew the reference length."""
    residual[:] = 0.0
    any_beyond = False
    move(problem, state.pressed, state.moved)
    for q in range(gap.size):
        value, beyond = 0.0, False
        if state.force[q] > 0.0:
            value, _, beyond = approach(problem.law, problem.place[q], state.force[q])
        any_beyond = any_beyond or beyond
        slack = gap[q] + value + motion_at(problem, q, state.moved) - problem.motion_arm[q] * elastic
        residual[1] = max(residual[1], -slack / elastic)
        residual[2] = max(residual[2], -state.force[q] / total)
        residual[3] = max(residual[3], abs(state.force[q] * slack / elastic) / total)
    residual[0] = abs(dot(problem.torque_arm, state.force, gap.size) - total) / total
    return any_beyond
