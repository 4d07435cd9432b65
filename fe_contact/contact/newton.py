"""Newton's method for one position of the contact: which contacts carry, and how much.

Terms: a contact is a short length of a contact line; q counts the m of them. A curve is a shape of force over
the face of a tooth pair; the bodies know n of them, and the force of a contact is spread over a few curves
beside each other, in the shares N (m, n). The strip is the width over which a contact is pressed flat; the
local law describes the compliance nearer to it than the reference length. The motion arm a_q is the normal
approach of contact q per unit deflection, the torque arm b_q its share of the load per unit force.

Find the forces on the curves h (n,) and the deflection d that satisfy

    h = N'F,    F_q = phi_q(a_q d - g_q - (N u(h))_q) >= 0,    sum_q b_q F_q = T.

Here u(h) are the motions of the bodies, the gradient of their energy W(h); g_q is the gap; T is the load; and
phi_q is the inverse of the local approach, which is convex, and zero where the flanks part. No search for the
carrying contacts is needed: each force follows from the approach of its contact.

With D = diag(dphi_q) and K = du/dh, Newton's matrix is 1 + N'DN K. Only the curves over contacts that touch
have rows in it. If a = b, the equations are those of the least energy

    h'u - W(h) + sum_q Phi_q(a_q d - g_q - (N u)_q) - T d,    dPhi_q = phi_q;

off the line of action a and b differ by one per cent. A whole step may go too far where contacts begin to
touch; it is then shortened to where the energy along it is least (docs/theory/contact.md).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.contact.elimination import any_nonzero, copy, dot, eliminate, largest_size, subtract
from fe_contact.contact.kernel import kernel
from fe_contact.contact.local_law import approach, plain_approach, width_of
from fe_contact.contact.point_problem import (
    PointProblem,
    State,
    begin,
    evaluate,
    motion_at,
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
"""Largest motion of a step over the deflection, at which the iteration ends.

The error after a step of Newton's method is of the order of the square of the step, so that the motions are
then exact to rounding.
"""
STRAIGHT = 1e-8
"""Largest motion of a step over the deflection, below which `_settle` tries to end the iteration.

It then follows the tangents of the local laws instead of evaluating them once more.
"""
ROUNDING = 1e-7
"""Largest motion of a step over the deflection, below which steps that no longer shrink count as rounding.

Where bodies have a large tilt the steps do not become smaller than this.
"""
_CUTS = 30
"""Most trials of a step's length; the last one is accepted in any case."""
_LEVEL = 0.3
"""Slope of the energy at the end of a step over its slope at the beginning, above which the step is cut."""
_SHRINKS = 0.1
"""Size of a step over the previous one, above which it does not shrink as steps of Newton's method do."""


class NewtonSystem(NamedTuple):
    """Newton's equations of the curves over touching contacts, the members.

    The arrays have room for all n curves. With k members, the first k entries of `member` and `right` and the
    leading k x k blocks of `matrix` and `compliance` are filled in.
    """

    member: IntArray
    """Indices of the members among all curves, increasing. Shape (n,)."""
    touching: FloatArray
    """The band of the symmetric N'DN in N/m: entry (k, c) is that of curves k and k - c. The band has the
    width w, the number of curves over which a contact spreads. Shape (n, w).
    """
    matrix: FloatArray
    compliance: FloatArray
    """`matrix`, `compliance`: 1 + N'DN K, and K in m/N, of the members. Shape (n, n) each."""
    right: FloatArray
    """Right-hand sides, which the elimination turns into solutions. Row 0: N'D a, N/m. Row 1: the defect of
    the forces on the curves, N'F - h, N. Shape (2, n).
    """
    shares: FloatArray
    """N'D b of all curves, N/m. Shape (n,)."""
    parted_load: FloatArray
    """Forces h - N'F that remain on curves whose contacts have parted, N; zero of members. Shape (n,)."""
    pulled: FloatArray
    """N'D a of all curves, N/m. Shape (n,)."""
    pushed: FloatArray
    """Heights of the members under the forces that remain on parted curves, m. Shape (n,)."""
    change: FloatArray
    motion: FloatArray
    """`change`, `motion`: Changes of curve forces by a step, N, and of heights, m. Shape (n,) each."""
    load_before: FloatArray
    """Forces on the curves before a step, N. Shape (n,)."""
    defect: FloatArray
    """Forces h - N'F at the end of a step, N. Shape (n,)."""
    gap: FloatArray
    """Normal gaps where the first contact touches, m: the smallest is zero. Shape (m,)."""


@inner(error_model="numpy")
def empty_system(problem: PointProblem) -> NewtonSystem:
    """Return the equations of a problem with all arrays allocated and none filled in.

    The solutions of a position at several loads use them one after the other.
    """
    n = problem.bodies.shape[0]
    of_curves = np.empty((8, n))
    return NewtonSystem(
        member=np.empty(n, dtype=np.int64),
        touching=np.empty((n, problem.curve.shape[1])),
        matrix=np.empty((n, n)),
        compliance=np.empty((n, n)),
        right=np.empty((2, n)),
        shares=of_curves[0],
        parted_load=of_curves[1],
        pulled=of_curves[2],
        pushed=of_curves[3],
        change=of_curves[4],
        motion=of_curves[5],
        load_before=of_curves[6],
        defect=of_curves[7],
        gap=np.empty(problem.gap.size),
    )


@inner(error_model="numpy")
def solve_point(
    problem: PointProblem, total: float, force: FloatArray, residual: FloatArray
) -> tuple[float, float, int, int, bool]:
    """Solve one position at one load with arrays of its own; see `solve_in`."""
    return solve_in(
        problem, total, force, residual, pressed_state(problem, force.copy()), empty_system(problem)
    )


@kernel
def solve_in(
    problem: PointProblem,
    total: float,
    force: FloatArray,
    residual: FloatArray,
    state: State,
    system: NewtonSystem,
) -> tuple[float, float, int, int, bool]:
    """Solve one position at one load.

    Parameters
    ----------
    total : float
        Right-hand side of the equilibrium in N, > 0.
    force : ndarray, shape (m,)
        In: starting forces, or zeros. Out: the solution.
    residual : ndarray, shape (4,)
        Out: equilibrium, penetration, tension and complementarity, in this order. Forces are relative to the
        load, lengths to the elastic deflection.
    state, system : State, NewtonSystem
        Arrays of the position that the solution fills in.

    Returns
    -------
    deflection, tangent : float
        Deflection in m, and its derivative with respect to `total`, m/N.
    status, iterations : int
        `CONVERGED`, `ITERATION_LIMIT`, `SINGULAR` (a compliance or a gap that is not finite, or no unique
        step), or `OUT_OF_MODEL` (no contact exists).
    beyond : bool
        Whether the strip of any contact is wider than the reference length allows.
    """
    residual[:] = math.inf
    if force.size == 0:
        return math.nan, math.nan, OUT_OF_MODEL, 0, False
    rigid, gap = _first_touch(problem), system.gap
    # Bodies that are all zero have no unique motion; a sum that is not finite comes from a bad compliance.
    if math.isnan(rigid) or not 0.0 < _sum_of_sizes(problem.bodies) < math.inf:
        force[:] = 0.0
        return math.nan, math.nan, SINGULAR, 0, False
    for q in range(gap.size):
        gap[q] = problem.gap[q] - problem.motion_arm[q] * rigid
    begin(problem, force, state)
    elastic = _start(problem, total, gap, state)
    elastic, tangent, status, iterations = _iterate(problem, total, gap, elastic, state, system)
    copy(state.force, force)
    if status == SINGULAR:
        return math.nan, math.nan, status, iterations, False
    beyond = _residuals(problem, total, elastic, gap, state, residual)
    return rigid + elastic, tangent, status, iterations, beyond


@kernel
def _first_touch(problem: PointProblem) -> float:
    """Return the deflection at which the first contact touches, m; NaN where any gap is."""
    least = math.inf
    for q in range(problem.gap.size):
        deflection = problem.gap[q] / problem.motion_arm[q]
        if math.isnan(deflection):
            return math.nan
        least = min(least, deflection)
    return least


@kernel
def _sum_of_sizes(matrix: FloatArray) -> float:
    """Return the sum of the absolute values of a matrix."""
    total = 0.0
    for i in range(matrix.shape[0]):
        for j in range(matrix.shape[1]):
            total += abs(matrix[i, j])
    return total


@kernel
def _start(problem: PointProblem, total: float, gap: FloatArray, state: State) -> float:
    """Fill in the state from the starting forces, or from a guess if they are zero; return their deflection.

    The elastic deflection is the mean over the contacts of (gap + local approach + motion) / motion arm,
    weighted by force and arm: F'(g + approach + N u) / F'a. A guess needs no exact local law.
    """
    for q in range(gap.size):
        state.force[q] = max(state.force[q], 0.0)
    guessed = not any_nonzero(state.force)
    if guessed:
        _guess(problem, total, gap, state.force)
    press(problem, state.force, state.curve_load)
    move(problem, state)
    law, force = problem.law, state.force
    work, arm = 0.0, 0.0  # F'(g + approach + N u) in N m, and F'a in N
    for q in range(gap.size):
        if force[q] > 0.0:
            value = plain_approach(law, q, force[q]) if guessed else approach(law, q, force[q])[0]
            work += force[q] * (gap[q] + value + motion_at(problem, q, state.displacement))
            arm += force[q] * problem.motion_arm[q]
    elastic = work / arm
    evaluate(problem, gap, elastic, state)
    return float(elastic)


@kernel
def _guess(problem: PointProblem, total: float, gap: FloatArray, force: FloatArray) -> None:
    """Fill in a guess of the forces: each contact carries in proportion to its width and its penetration.

    The depth of penetration is that of the first contact to touch, if it alone carried the load.
    """
    first = 0  # the contact that touches first
    for q in range(gap.size):
        if gap[q] < gap[first]:
            first = q
    depth = total * _softness(problem, first)
    carried = 0.0  # the load that the forces carry before they are scaled to `total`
    for q in range(gap.size):
        force[q] = max(depth - gap[q], 0.0) * width_of(problem.law, q)
        carried += problem.torque_arm[q] * force[q]
    scale = total / carried
    for q in range(gap.size):
        force[q] *= scale


@kernel
def _softness(problem: PointProblem, q: int) -> float:
    """Return an upper bound of the motion of the bodies at a contact per unit force on it, m/N.

    It adds the absolute values of all terms, as curves may have either sign.
    """
    first, curve = problem.first[q], problem.curve[q]
    total = 0.0
    for a in range(curve.size):
        for b in range(curve.size):
            total += abs(curve[a] * curve[b] * problem.bodies[first + a, first + b])
    return total


@kernel
def _iterate(
    problem: PointProblem, total: float, gap: FloatArray, elastic: float, state: State, system: NewtonSystem
) -> tuple[float, float, int, int]:
    """Iterate to the solution; return elastic deflection, tangent, status and iterations.

    Each iteration eliminates the forces on the curves. One equation is left for the deflection: its stiffness
    times the step balances the excess of the load and the defect of the forces on the curves.
    """
    change, motion = system.change, system.motion
    tangent = math.nan
    last = math.inf  # largest motion of the last step, m
    for iteration in range(1, MAX_ITERATIONS + 1):
        if not any_nonzero(state.slope):  # the last step went too far and has parted all flanks
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
        for k in range(change.size):  # to N'F, also on curves whose contacts have parted
            change[k] = state.pressed[k] - state.curve_load[k]
        for r in range(size):
            change[system.member[r]] = step * system.right[0, r] + system.right[1, r]
        yield_to(state.yielding, change, motion)
        before = last
        last = max(abs(step), largest_size(motion))
        if last <= STRAIGHT * elastic and _settle(problem, gap, elastic, step, motion, state):
            return elastic + step, tangent, CONVERGED, iteration
        elastic = _advance(problem, total, gap, elastic, step, state, system)
        rounding = before <= ROUNDING * elastic and last > _SHRINKS * before
        if last <= STEP_TOLERANCE * elastic or rounding:
            return elastic, tangent, CONVERGED, iteration
    return elastic, tangent, ITERATION_LIMIT, MAX_ITERATIONS


@kernel
def _settle(
    problem: PointProblem, gap: FloatArray, elastic: float, step: float, motion: FloatArray, state: State
) -> bool:
    """Take the last step along the tangents of the local laws; return False if a law bends too much for it.

    A law bends over a scale of its own approach, so that the error of the tangent is about the change of the
    approach squared, over the approach. It is compared with the step tolerance of the deflection. Nothing is
    changed where False is returned.
    """
    m, arm = gap.size, problem.motion_arm
    for q in range(m):
        change = arm[q] * step - motion_at(problem, q, motion)
        approached = arm[q] * elastic - gap[q] - motion_at(problem, q, state.displacement)
        # "not <=" is true of NaN, too
        if not change * change <= STEP_TOLERANCE * elastic * abs(approached):
            return False
    for q in range(m):
        state.force[q] += state.slope[q] * (arm[q] * step - motion_at(problem, q, motion))
    press(problem, state.force, state.pressed)
    return True


@kernel
def _condensed(problem: PointProblem, state: State, system: NewtonSystem, size: int) -> tuple[float, float]:
    """Return stiffness and defect of the load after the curves are eliminated, N/m and N.

    The stiffness is that of contacts on rigid bodies, less b'D N K times the solution of the members for a
    unit step (row 0). The defect is the change of the load by the solution of row 1 and by the forces that
    remain on parted curves.
    """
    stiff = stiffness(problem, state)
    residual = 0.0
    for r in range(state.curve_load.size):
        if system.shares[r] != 0.0:
            for s in range(size):
                yielding = system.shares[r] * state.yielding[r, system.member[s]]
                stiff -= yielding * system.right[0, s]
                residual -= yielding * system.right[1, s]
            residual += system.shares[r] * dot(state.yielding[r], system.parted_load, system.parted_load.size)
    return stiff, residual


@kernel
def _advance(
    problem: PointProblem,
    total: float,
    gap: FloatArray,
    elastic: float,
    step: float,
    state: State,
    system: NewtonSystem,
) -> float:
    """Take a step, or a part of it that ends near the least energy along it; return the elastic deflection.

    `fall` and `rise` are the slopes of the energy along the step, at its beginning and at the trial length.
    """
    load_before, elastic_before = system.load_before, elastic
    copy(state.curve_load, load_before)
    fall = _energy_slope(problem, total, step, state, system)
    # The least energy lies between the lengths low and high; the slopes there are at_low < 0 and at_high > 0.
    low, at_low = 0.0, fall
    high, at_high = math.inf, math.inf
    length = 1.0
    for _ in range(_CUTS):
        elastic = elastic_before + length * step
        for k in range(load_before.size):
            state.curve_load[k] = load_before[k] + length * system.change[k]
        move(problem, state)
        evaluate(problem, gap, elastic, state)
        rise = _energy_slope(problem, total, step, state, system)
        # Accept the length if the energy does not fall even at the beginning (rounding), if its slope is
        # small
        # enough at this length, or if it still falls at the end of the whole step.
        if not fall < 0.0 or abs(rise) <= -_LEVEL * fall or (rise < 0.0 and high == math.inf):
            break
        if rise > 0.0:
            high, at_high = length, rise
        else:
            low, at_low = length, rise
        # Take the zero of the secant through the two slopes, but stay a tenth of the interval from its ends.
        length = low + min(max(at_low / (at_low - at_high), 0.1), 0.9) * (high - low)
    return elastic


@kernel
def _energy_slope(
    problem: PointProblem, total: float, step: float, state: State, system: NewtonSystem
) -> float:
    """Return the slope of the energy along a step in N m, at forces and displacements of the state."""
    defect = system.defect
    for k in range(defect.size):
        defect[k] = state.curve_load[k] - state.pressed[k]
    slope = (dot(problem.torque_arm, state.force, state.force.size) - total) * step
    slope += dot(system.motion, defect, defect.size)
    return slope


@kernel
def newton_system(problem: PointProblem, state: State, system: NewtonSystem) -> int:
    """Fill in Newton's equations; return the number of curves over contacts that touch."""
    # N'D a in N/m of all curves; motion in m of the members by the forces that remain on parted curves
    pulled, pushed = system.pulled, system.pushed
    pulled[:] = 0.0
    fill_yielding(problem, state)
    _touching(problem, state, system, pulled)
    parted_load, member = system.parted_load, system.member
    size = 0
    parted_load[:] = 0.0
    for k in range(parted_load.size):
        if system.touching[k, 0] > 0.0:
            member[size] = k
            size += 1
        else:
            parted_load[k] = state.curve_load[k] - state.pressed[k]
    any_parted, width = any_nonzero(parted_load), system.touching.shape[1]
    for r in range(size):
        i = member[r]
        for s in range(size):
            system.compliance[r, s] = state.yielding[i, member[s]]
        system.right[0, r] = pulled[i]
        system.right[1, r] = state.pressed[i] - state.curve_load[i]
        pushed[r] = dot(state.yielding[i], parted_load, parted_load.size) if any_parted else 0.0
    for r in range(size):
        row = system.matrix[r, :size]
        row[:] = 0.0
        row[r] = 1.0
        # Members r and s are at least |r - s| curves apart: those outside the range share no contact.
        for s in range(max(r - width + 1, 0), min(r + width, size)):
            distance = abs(member[r] - member[s])
            if distance < width:
                part = system.touching[max(member[r], member[s]), distance]
                subtract(row, system.compliance[s, :size], -part)  # adds part times row s of K
                system.right[1, r] += part * pushed[s]
    return size


@kernel
def _touching(problem: PointProblem, state: State, system: NewtonSystem, pulled: FloatArray) -> None:
    """Fill in N'DN by its diagonals, `pulled` = N'D a and `shares` = N'D b, of all curves.

    `touching` holds one half of the symmetric N'DN, so that b runs up to a only.
    """
    touching, shares = system.touching, system.shares
    touching[:] = 0.0
    shares[:] = 0.0
    for q in range(state.force.size):
        slope, first = state.slope[q], problem.first[q]
        if slope != 0.0:
            for a in range(problem.curve.shape[1]):
                part = slope * problem.curve[q, a]
                pulled[first + a] += part * problem.motion_arm[q]
                shares[first + a] += part * problem.torque_arm[q]
                for b in range(a + 1):
                    touching[first + a, a - b] += part * problem.curve[q, b]


@kernel
def _residuals(
    problem: PointProblem,
    total: float,
    elastic: float,
    gap: FloatArray,
    state: State,
    residual: FloatArray,
) -> bool:
    """Fill `residual` (4,); return whether any strip is wider than the reference length allows.

    The residuals are those of equilibrium, penetration, tension and complementarity, in this order.
    """
    residual[:] = 0.0
    any_beyond = False
    copy(state.pressed, state.curve_load)
    move(problem, state)
    law, force = problem.law, state.force
    for q in range(gap.size):
        value, beyond = 0.0, False
        if force[q] > 0.0:
            value, _, beyond = approach(law, q, force[q])
        any_beyond = any_beyond or beyond
        motion = motion_at(problem, q, state.displacement)
        slack = gap[q] + value + motion - problem.motion_arm[q] * elastic
        residual[1] = max(residual[1], -slack / elastic)
        residual[2] = max(residual[2], -force[q] / total)
        residual[3] = max(residual[3], abs(force[q] * slack / elastic) / total)
    residual[0] = abs(dot(problem.torque_arm, state.force, gap.size) - total) / total
    return any_beyond
