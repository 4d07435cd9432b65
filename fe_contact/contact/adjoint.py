"""Derivatives of transmission error and load arm from the solved contact, by its adjoint.

The load is n'F, the share n of every candidate in the equilibrium (`torque_share`) times its normal force F.
The derivatives are by gaps g that take away normal approach: m d - g is the approach at deflection d, with m
the `motion_arm`. S is the symmetric stiffness of the contact at a solution: dF = S (m dd - dg). Shapes: P
positions, L loads, m candidates, R or A rows of gaps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.contact.elimination import dot, eliminate
from fe_contact.contact.local_law import approach, carrying_strip
from fe_contact.contact.newton import empty_system, newton_system
from fe_contact.contact.point_problem import (
    PointProblem,
    PointProblems,
    motion_at,
    point_problems,
    press,
    pressed_state,
    problem_on,
    row_bodies,
)
from fe_contact.contact.problem import Candidates, ContactProblem
from fe_contact.contact.sweep import ContactSolution
from fe_contact.contact.tilted_bodies import yield_to
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray, Status
from host.loops import inner, njit


@dataclass(frozen=True)
class _Adjoint:
    """Influences of m candidates on STE and load arm at P positions and L loads, and the strips."""

    weight: FloatArray
    """dSTE per normal approach taken away at each candidate, 1; zero where it does not carry, NaN where the
    contact is not solved. Their sum over the candidates, times `Candidates.motion_arm`, is 1. Shape (P, L,
    m).
    """
    arm_weight: FloatArray
    """Change of the load arm per normal approach taken away at each candidate. The sum over the candidates,
    times `Candidates.motion_arm`, is 0. Shape (P, L, m).
    """
    added_arm: FloatArray
    """Arm of the increment by which the load grows, m. Shape (P, L)."""
    middle: FloatArray
    half: FloatArray
    """`middle`, `half`: Distance of the middle of each contact strip from the touching point, > 0 towards tip
    1, and half the strip's length, m. Shape (P, L, m) each.
    """


def load_arm(pair: ParallelAxes, problem: ContactProblem, solution: ContactSolution) -> FloatArray:
    """Return the arm of the load about the axis of a misalignment (P, L), m."""
    _, moments = _shares(pair, problem.candidates)
    return np.asarray(np.einsum("plm,pm->pl", solution.force, moments) / solution.load)


def _shares(pair: ParallelAxes, c: Candidates) -> FloatArray:
    """Return the shares of the load per unit force, and the shares times the arms in m, (2, P, m)."""
    return c.torque_share * np.stack([np.ones(c.gap.shape), pair.tilt_arm(c.touch.roll_1, c.face_position)])


def adjoint(pair: ParallelAxes, problem: ContactProblem, solution: ContactSolution) -> _Adjoint:
    """Find the weights of all candidates, and the strips, of a solved problem.

    At constant load n'dF = 0, so from dF = S (m dSTE - dg) the weights of the STE are S n/(n'S m). With the
    arms z, those of the load arm are (b S n - S (n z))/load, where b = n z'S m/(n'S m) is `added_arm`.
    """
    c = problem.candidates
    # S n and S (n z); then the strips
    pushed, (middle, half) = (np.zeros((2, *solution.force.shape)) for _ in range(2))
    weigh(point_problems(problem), solution.force, _shares(pair, c), pushed, middle, half)
    pushed[:, solution.status != Status.CONVERGED] = np.nan
    stiffness, of_arm = np.einsum("rplm,pm->rpl", pushed, c.motion_arm)
    weight, added_arm = pushed[0] / stiffness[..., None], of_arm / stiffness
    arm_weight = (added_arm[..., None] * pushed[0] - pushed[1]) / solution.load[:, None]
    return _Adjoint(weight=weight, arm_weight=arm_weight, added_arm=added_arm, middle=middle, half=half)


@njit(cache=True, error_model="numpy")
def weigh(
    every: PointProblems,
    force: FloatArray,
    shares: FloatArray,
    pushed: FloatArray,
    middle: FloatArray,
    half: FloatArray,
) -> None:
    """Fill in `pushed` (R, P, L, m), S times the rows of shares (R, P, m), and the strips (P, L, m).

    Positions with one row of `every.bodies` follow each other, so that its arrays are prepared once.
    """
    count = every.bodies.shape[0]
    for row in range(count):
        bodies = row_bodies(every, row)
        for p in range(row, force.shape[0], count):
            problem, touching = problem_on(every, bodies, p)
            rows = np.ascontiguousarray(shares[:, p][:, touching])
            for k in range(force.shape[1]):
                parts = _pushed(problem, force[p, k][touching], rows)
                for q in range(touching.size):
                    at, carried = touching[q], force[p, k, touching[q]]
                    pushed[:, p, k, at] = parts[:, q]
                    if carried > 0.0:
                        middle[p, k, at], half[p, k, at] = carrying_strip(problem.law, q, carried)


@inner(error_model="numpy")
def _pushed(problem: PointProblem, force: FloatArray, rows: FloatArray) -> FloatArray:
    """Return S times rows (R, m): the fall of the forces as rows move contacts apart, at one deflection.

    S = D (1 - N K (1 + N'DN K)^-1 N'D): D the diagonal of the local law's stiffnesses at the solution, N the
    curves by which forces act on the bodies, K the compliance of the bodies between the curves.
    """
    state = pressed_state(problem, force)
    # exact stiffnesses at the solution's forces in place of those of Newton's last step
    for q in range(force.size):
        if force[q] > 0.0:
            state.slope[q] = 1.0 / approach(problem.law, q, force[q])[1]
    system = empty_system(problem)
    size = newton_system(problem, state, system)
    pressed, motion = np.zeros((2, state.curve_load.size))
    right, out = np.zeros((len(rows), size)), np.full(rows.shape, np.nan)
    for a in range(len(rows)):
        press(problem, state.slope * rows[a], pressed)
        for r in range(size):
            right[a, r] = pressed[system.member[r]]
    if not eliminate(system.matrix, right, size):
        return out
    for a in range(len(rows)):
        pressed[:] = 0.0
        for r in range(size):
            pressed[system.member[r]] = right[a, r]
        yield_to(state.yielding, pressed, motion)
        for q in range(force.size):
            out[a, q] = state.slope[q] * (rows[a, q] - motion_at(problem, q, motion))
    return out


def force_changes(problem: ContactProblem, solution: ContactSolution, opened: FloatArray) -> FloatArray:
    """Return how the forces change as contacts are moved apart, at the same load.

    Parameters
    ----------
    problem, solution
    opened : ndarray, shape (A, P, L, m)
        Normal approach taken away from each candidate by A changes, m; only candidates that carry count.

    Returns
    -------
    ndarray, shape (A, P, L, m)
        N.
    """
    changes = np.zeros(opened.shape)
    _respond(point_problems(problem), solution.force, opened, changes)
    return changes


@njit(cache=True, error_model="numpy")
def _respond(every: PointProblems, force: FloatArray, opened: FloatArray, changes: FloatArray) -> None:
    """Fill in the changes of the forces of all positions and loads: dF = S (m dd - dg), n'dF = 0.

    `lag` is dd over `opened`, the change of the deflection at constant load.
    """
    count = every.bodies.shape[0]
    for row in range(count):
        bodies = row_bodies(every, row)
        for p in range(row, force.shape[0], count):
            problem, touching = problem_on(every, bodies, p)
            rows = np.empty((len(opened) + 1, touching.size))
            rows[0] = problem.motion_arm
            for k in range(force.shape[1]):
                rows[1:] = opened[:, p, k][:, touching]
                parts = _pushed(problem, force[p, k][touching], rows)
                stiff = dot(problem.torque_arm, parts[0], touching.size)
                for a in range(len(opened)):
                    lag = dot(problem.torque_arm, parts[a + 1], touching.size) / stiff
                    changes[a, p, k][touching] = lag * parts[0] - parts[a + 1]
