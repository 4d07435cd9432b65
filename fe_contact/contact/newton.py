"""Newton's method for one contact point problem: who carries what.

The bodies move by n curves over the face, each over a few contacts; m contacts press on them by the parts
N (m, n) of their forces. Find the forces on the curves h (n,) and the deflection d with

    h = N'F,    F_q = phi_q(m_q d - g_q - (N u(h))_q) >= 0,    sum_q n_q F_q = T,

u the motions of the bodies, the gradient of their energy W(h), and phi_q, the inverse of the local approach,
convex and zero where flanks part. Which contacts carry needs no search: each follows from its own approach.
With D the slopes of phi and K = du/dh, Newton's matrix is 1 + N'DN K, and only the curves over contacts that
touch have rows in it. With m = n this is the search for the least energy

    h'u - W(h) + sum_q Phi_q(m_q d - g_q - (N u)_q) - T d;

off the line of action m and n differ by a per cent. A whole step may go too far where contacts enter; it is
then cut to where the energy along it is least (docs/theory/contact.md).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.contact.elimination import dot, eliminate, subtract
from fe_contact.contact.local_law import approach, plain_approach, width_of
from fe_contact.contact.point_problem import (
    PointProblem,
    State,
    evaluate,
    motions,
    press,
    pressed_state,
    stiffness,
)
from fe_contact.contact.tilted_bodies import fill_yielding, move, yield_to
from fe_contact.types import FloatArray, IntArray
from host.loops import inner

CONVERGED, ITERATION_LIMIT, SINGULAR, OUT_OF_MODEL = 0, 1, 2, 3
"""The values of `fe_contact.types.Status` that this solver gives."""

MAX_ITERATIONS = 100
STEP_TOLERANCE = 1e-11
"""Largest last change of the motions over the deflection; Newton squares it, so they are good to rounding."""
STRAIGHT = 1e-8
"""The same of a step over which the laws may be straight enough for the forces to follow without them."""
ROUNDING = 1e-7
"""The same, below which steps that do not fall any more are rounding: of bodies that turn by much."""
_CUTS = 30
_LEVEL = 0.3
"""Slope of the energy at the end of a step over its fall at the beginning, from which on the step is cut."""


class NewtonSystem(NamedTuple):
    """Newton's equations of the curves over touching contacts; filled up to their number."""

    member: IntArray
    """Those curves. Shape (n,)."""
    touching: FloatArray
    """N'DN of all curves with those up to w - 1 before them, N/m. Shape (n, w)."""
    matrix: FloatArray
    compliance: FloatArray
    """`matrix`, `compliance`: 1 + N'DN K, and K of the members, m/N. Shape (n, n) each."""
    right: FloatArray
    """N'D m in N/m, and what the forces on the curves miss in N. Shape (2, n)."""
    shares: FloatArray
    """N'D n of all curves, N/m. Shape (n,)."""
    left: FloatArray
    """Forces on curves whose contacts do not touch any more, N. Shape (n,)."""


@inner(error_model="numpy")
def empty_system(problem: PointProblem) -> NewtonSystem:
    """Return room for the equations of a problem."""
    n = problem.bodies.shape[0]
    member, touching = np.empty(n, dtype=np.int64), np.empty((n, problem.curve.shape[1]))
    square, right, line = np.empty((2, n, n)), np.empty((2, n)), np.empty((2, n))
    return NewtonSystem(member, touching, square[0], square[1], right, line[0], line[1])


@inner(error_model="numpy")
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
    if math.isnan(touch) or not 0.0 < np.abs(problem.bodies).sum() < math.inf:
        force[:] = 0.0
        return math.nan, math.nan, SINGULAR, 0, False
    state = pressed_state(problem, force)
    elastic = _start(problem, total, gap, state)
    elastic, tangent, status, iterations = _iterate(problem, total, gap, elastic, state)
    if status == SINGULAR:
        return math.nan, math.nan, status, iterations, False
    beyond = _residuals(problem, total, elastic, gap, state, residual)
    return touch + elastic, tangent, status, iterations, beyond


@inner(error_model="numpy")
def _start(problem: PointProblem, total: float, gap: FloatArray, state: State) -> float:
    """Fill the state by the given forces, or a guess of them; return the elastic deflection they ask for."""
    state.force[:] = np.maximum(state.force, 0.0)
    guessed = not state.force.any()
    if guessed:
        _guess(problem, total, gap, state.force)
    press(problem, state.force, state.curve_load)
    move(problem, state)
    law, force, motion = problem.law, state.force, motions(problem, state.displacement)
    needed, arm = 0.0, 0.0
    for q in range(gap.size):
        if force[q] > 0.0:
            value = plain_approach(law, q, force[q]) if guessed else approach(law, q, force[q])[0]
            needed += force[q] * (gap[q] + value + motion[q])
            arm += force[q] * problem.motion_arm[q]
    elastic = needed / arm
    evaluate(problem, gap, elastic, state)
    return float(elastic)


@inner(error_model="numpy")
def _guess(problem: PointProblem, total: float, gap: FloatArray, force: FloatArray) -> None:
    """Fill in forces as the gaps would take them if all contacts gave way as the first one to touch."""
    depth, carried = total * _softness(problem, int(np.argmin(gap))), 0.0
    for q in range(gap.size):
        force[q] = max(depth - gap[q], 0.0) * width_of(problem.law, q)
        carried += problem.torque_arm[q] * force[q]
    force *= total / carried


@inner(error_model="numpy")
def _softness(problem: PointProblem, q: int) -> float:
    """Return how far the bodies move at most at a contact under a unit force on it, m/N."""
    total, first, curve = 0.0, problem.first[q], problem.curve[q]
    for a in range(curve.size):
        for b in range(curve.size):
            total += abs(curve[a] * curve[b] * problem.bodies[first + a, first + b])
    return total


@inner(error_model="numpy")
def _iterate(
    problem: PointProblem, total: float, gap: FloatArray, elastic: float, state: State
) -> tuple[float, float, int, int]:
    """Iterate to the solution; return elastic deflection, tangent, status and iterations."""
    system = empty_system(problem)
    change, motion = np.empty((2, state.curve_load.size))
    tangent, last = math.nan, math.inf
    for iteration in range(1, MAX_ITERATIONS + 1):
        if not state.slope.any():  # a step too far has parted all flanks
            elastic = _start(problem, total, gap, state)
        size = newton_system(problem, state, system)
        if not eliminate(system.matrix, system.right, size):
            return math.nan, math.nan, SINGULAR, iteration
        excess = dot(problem.torque_arm, state.force, gap.size) - total
        stiff, residual = _condensed(problem, state, system, size)
        if not 0.0 < stiff < math.inf:
            return math.nan, math.nan, SINGULAR, iteration
        tangent = 1.0 / stiff
        step = -(excess + residual) * tangent
        change[:] = state.pressed - state.curve_load  # where nothing touches the forces go
        for r in range(size):
            change[system.member[r]] = step * system.right[0, r] + system.right[1, r]
        yield_to(state.yielding, change, motion)
        before, last = last, max(abs(step), np.abs(motion).max())
        if last <= STRAIGHT * elastic and _settle(problem, gap, elastic, step, motion, state):
            return elastic + step, tangent, CONVERGED, iteration
        elastic = _advance(problem, total, gap, elastic, step, change, motion, state)
        rounding = before <= ROUNDING * elastic and last > 0.1 * before
        if last <= STEP_TOLERANCE * elastic or rounding:
            return elastic, tangent, CONVERGED, iteration
    return elastic, tangent, ITERATION_LIMIT, MAX_ITERATIONS


@inner(error_model="numpy")
def _settle(
    problem: PointProblem, gap: FloatArray, elastic: float, step: float, motion: FloatArray, state: State
) -> bool:
    """Add what a last step changes of the forces; not if a law is bent by more than the tolerance over it."""
    m, arm = gap.size, problem.motion_arm
    nearer, motion_before = motions(problem, motion), motions(problem, state.displacement)
    for q in range(m):
        nearer[q] = arm[q] * step - nearer[q]
        closer = arm[q] * elastic - gap[q] - motion_before[q]
        if not nearer[q] * nearer[q] <= STEP_TOLERANCE * elastic * abs(closer):
            return False
    for q in range(m):
        state.force[q] += state.slope[q] * nearer[q]
    press(problem, state.force, state.pressed)
    return True


@inner(error_model="numpy")
def _condensed(problem: PointProblem, state: State, system: NewtonSystem, size: int) -> tuple[float, float]:
    """Return the stiffness of the position in N/m, and what the curves miss of the load in N."""
    stiff, residual = stiffness(problem, state), 0.0
    for r in range(state.curve_load.size):
        if system.shares[r] != 0.0:
            for s in range(size):
                yielding = system.shares[r] * state.yielding[r, system.member[s]]
                stiff -= yielding * system.right[0, s]
                residual -= yielding * system.right[1, s]
            residual += system.shares[r] * dot(state.yielding[r], system.left, system.left.size)
    return stiff, residual


@inner(error_model="numpy")
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
    pressed, before = state.curve_load.copy(), elastic
    fall = (dot(problem.torque_arm, state.force, gap.size) - total) * step
    fall += dot(motion, state.curve_load - state.pressed, motion.size)
    low, high, at_low, at_high, length = 0.0, math.inf, fall, math.inf, 1.0
    for _ in range(_CUTS):
        elastic = before + length * step
        state.curve_load[:] = pressed + length * change
        move(problem, state)
        evaluate(problem, gap, elastic, state)
        rise = (dot(problem.torque_arm, state.force, gap.size) - total) * step
        rise += dot(motion, state.curve_load - state.pressed, motion.size)
        if not fall < 0.0 or abs(rise) <= -_LEVEL * fall or (rise < 0.0 and high == math.inf):
            break
        if rise > 0.0:
            high, at_high = length, rise
        else:
            low, at_low = length, rise
        length = low + min(max(at_low / (at_low - at_high), 0.1), 0.9) * (high - low)
    return elastic


@inner(error_model="numpy")
def newton_system(problem: PointProblem, state: State, system: NewtonSystem) -> int:
    """Fill in Newton's equations; return the number of curves over contacts that touch."""
    pulled, pushed = np.zeros((2, state.curve_load.size))
    fill_yielding(problem, state)
    _touching(problem, state, system, pulled)
    size, left, member = 0, system.left, system.member
    left[:] = 0.0
    for k in range(left.size):
        if system.touching[k, 0] > 0.0:
            member[size] = k
            size += 1
        else:
            left[k] = state.curve_load[k] - state.pressed[k]
    any_left, width = left.any(), system.touching.shape[1]
    for r in range(size):
        i = member[r]
        for s in range(size):
            system.compliance[r, s] = state.yielding[i, member[s]]
        system.right[0, r], system.right[1, r] = pulled[i], state.pressed[i] - state.curve_load[i]
        pushed[r] = dot(state.yielding[i], left, left.size) if any_left else 0.0
    for r in range(size):
        row = system.matrix[r, :size]
        row[:] = 0.0
        row[r] = 1.0
        for s in range(max(r - width + 1, 0), min(r + width, size)):
            distance = abs(member[r] - member[s])
            if distance < width:
                part = system.touching[max(member[r], member[s]), distance]
                subtract(row, system.compliance[s, :size], -part)
                system.right[1, r] += part * pushed[s]
    return size


@inner(error_model="numpy")
def _touching(problem: PointProblem, state: State, system: NewtonSystem, pulled: FloatArray) -> None:
    """Fill in N'DN by its diagonals, N'D m and N'D n of all curves."""
    touching, shares = system.touching, system.shares
    touching[:], shares[:] = 0.0, 0.0
    for q in range(state.force.size):
        slope, first = state.slope[q], problem.first[q]
        if slope != 0.0:
            for a in range(problem.curve.shape[1]):
                part = slope * problem.curve[q, a]
                pulled[first + a] += part * problem.motion_arm[q]
                shares[first + a] += part * problem.torque_arm[q]
                for b in range(a + 1):
                    touching[first + a, a - b] += part * problem.curve[q, b]


@inner(error_model="numpy")
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
    state.curve_load[:] = state.pressed
    move(problem, state)
    law, force, motion = problem.law, state.force, motions(problem, state.displacement)
    for q in range(gap.size):
        value, beyond = 0.0, False
        if force[q] > 0.0:
            value, _, beyond = approach(law, q, force[q])
        any_beyond = any_beyond or beyond
        slack = gap[q] + value + motion[q] - problem.motion_arm[q] * elastic
        residual[1] = max(residual[1], -slack / elastic)
        residual[2] = max(residual[2], -force[q] / total)
        residual[3] = max(residual[3], abs(force[q] * slack / elastic) / total)
    residual[0] = abs(dot(problem.torque_arm, state.force, gap.size) - total) / total
    return any_beyond
