"""Derivatives of the transmission error from the solved contact, by its adjoint.

Let every contact q be moved apart by a little: dg_q (m,) in m. With the notation of `newton`, forces and
deflection answer by

    dh = N'dF,    dF = D (m dd - dg - N K dh),    n'dF = 0,

so that dd = sum_q w_q dg_q with the weights

    w = D (n - N K u) t,    (1 + N'DN K) u = N'D n,    t = 1/(n - N K u)'D m the tangent dSTE/dload:

one more right-hand side of Newton's matrix gives the derivatives by everything that moves flanks apart. The
local approach of a contact is stationary in its strip, so that a change of the flanks counts by its mean over
the strip (docs/theory/contact.md, "Derivatives").
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from fe_contact.contact.elimination import dot, eliminate
from fe_contact.contact.local_law import approach, carrying_strip
from fe_contact.contact.newton import NewtonSystem, empty_system, newton_system
from fe_contact.contact.point_problem import (
    PointProblem,
    PointProblems,
    State,
    motion_at,
    move,
    point_problems,
    press,
    problem_at,
)
from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.solution import ContactSolution
from fe_contact.types import FloatArray, Status


@dataclass(frozen=True)
class Adjoint:
    """Influences on the transmission error of P positions at L loads, and their strips; m candidates.

    Attributes
    ----------
    weight : ndarray, shape (P, L, m)
        dSTE per normal approach taken away at each candidate, 1; zero where it does not carry, NaN where the
        contact is not solved. Their sum over the candidates, times `Candidates.motion_arm`, is 1.
    middle, half : ndarray, shape (P, L, m)
        Middle of each contact strip from the touching point on, towards tip 1, and half its length, m.
    """

    weight: FloatArray
    middle: FloatArray
    half: FloatArray


def adjoint(problem: ContactProblem, solution: ContactSolution) -> Adjoint:
    """Find the weights of all candidates, and the strips, of a solved problem."""
    weight, middle, half = np.zeros((3, *solution.force.shape))
    _weigh(point_problems(problem), solution.force, weight, middle, half)
    weight[solution.status != Status.CONVERGED] = np.nan
    return Adjoint(weight, middle, half)


@njit(cache=True, error_model="numpy")
def _weigh(
    every: PointProblems, force: FloatArray, weight: FloatArray, middle: FloatArray, half: FloatArray
) -> None:
    """Fill in the weights and strips of all positions and loads."""
    for p in range(force.shape[0]):
        problem, here = problem_at(every, p)
        for k in range(force.shape[1]):
            weights = _weights(problem, force[p, k][here])
            for q in range(here.size):
                if force[p, k, here[q]] > 0.0:
                    at = here[q]
                    weight[p, k, at] = weights[q]
                    middle[p, k, at], half[p, k, at] = carrying_strip(
                        problem.law, problem.place[q], force[p, k, at]
                    )


@njit(cache=True, error_model="numpy")
def _linearized(problem: PointProblem, force: FloatArray) -> tuple[State, NewtonSystem, int]:
    """Return the state of a solution, and Newton's equations there with their number."""
    n = problem.bodies.shape[0]
    state, system = State(np.zeros(n), np.zeros(n), force, np.zeros(force.size), np.zeros(n)), empty_system(n)
    for q in range(force.size):
        if force[q] > 0.0:
            state.slope[q] = 1.0 / approach(problem.law, problem.place[q], force[q])[1]
    press(problem, force, state.pressed)
    state.held[:] = state.pressed
    return state, system, newton_system(problem, state, system)


@njit(cache=True, error_model="numpy")
def _weights(problem: PointProblem, force: FloatArray) -> FloatArray:
    """Return the weights (m,) under the forces of a solution."""
    state, system, size = _linearized(problem, force)
    for r in range(size):
        system.right[0, r] = system.shares[system.member[r]]
    if not eliminate(system.matrix, system.right[:1], size):
        return np.full(force.size, np.nan)
    answer, motion = np.zeros((2, state.held.size))
    for r in range(size):
        answer[system.member[r]] = system.right[0, r]
    move(problem, answer, motion)
    weights, stiff = np.zeros(force.size), 0.0
    for q in range(force.size):
        if state.slope[q] > 0.0:
            weights[q] = state.slope[q] * (problem.torque_arm[q] - motion_at(problem, q, motion))
            stiff += weights[q] * problem.motion_arm[q]
    return weights / stiff


def force_changes(problem: ContactProblem, solution: ContactSolution, opened: FloatArray) -> FloatArray:
    """Return how the forces change as contacts are moved apart, at the same load.

    Parameters
    ----------
    problem, solution
    opened : ndarray, shape (A, P, L, m)
        Normal approach taken away from each candidate by A changes, m; of those that carry.

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
    """Fill in the changes of the forces of all positions and loads."""
    for p in range(force.shape[0]):
        problem, here = problem_at(every, p)
        for k in range(force.shape[1]):
            apart = np.ascontiguousarray(opened[:, p, k][:, here])
            answers = _answers(problem, force[p, k][here], apart)
            for a in range(answers.shape[0]):
                for q in range(here.size):
                    changes[a, p, k, here[q]] = answers[a, q]


@njit(cache=True, error_model="numpy")
def _answers(problem: PointProblem, force: FloatArray, opened: FloatArray) -> FloatArray:
    """Return the changes of the forces (A, m): dF = D (m dd - dg - N K dh), dh = y dd - z, n'dF = 0."""
    state, system, size = _linearized(problem, force)
    count, m = opened.shape
    right, rows = np.zeros((count + 1, size)), np.zeros((count + 1, state.held.size))
    right[0] = system.right[0, :size]  # N'D m
    for a in range(count):
        press(problem, state.slope * opened[a], rows[a + 1])
        for r in range(size):
            right[a + 1, r] = rows[a + 1, system.member[r]]
    if not eliminate(system.matrix, right, size):
        return np.full((count, m), np.nan)
    followed, motion, answers = np.zeros((count + 1, m)), np.zeros(state.held.size), np.zeros((count, m))
    for a in range(count + 1):
        rows[a, :] = 0.0
        for r in range(size):
            rows[a, system.member[r]] = right[a, r]
        move(problem, rows[a], motion)
        for q in range(m):
            arm = problem.motion_arm[q] if a == 0 else opened[a - 1, q]
            followed[a, q] = state.slope[q] * (arm - motion_at(problem, q, motion))
    stiff = dot(problem.torque_arm, followed[0], m)
    for a in range(count):
        lag = dot(problem.torque_arm, followed[a + 1], m) / stiff
        answers[a] = lag * followed[0] - followed[a + 1]
    return answers
