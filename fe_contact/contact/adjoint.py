"""Derivatives of transmission error and load arm from the solved contact, by its adjoint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.contact.elimination import dot, eliminate
from fe_contact.contact.local_law import approach, carrying_strip
from fe_contact.contact.newton import empty_system, newton_system
from fe_contact.contact.point_problem import (
    PointProblem,
    PointProblems,
    motions,
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
    """Influence of m candidates on STE and load arm at P positions and L loads, and their strips."""

    weight: FloatArray
    """dSTE per normal approach taken away at each candidate; zero where it carries no load, NaN where the
    contact is not solved. Their sum over the candidates, times `Candidates.motion_arm`, is 1. Shape (P, L,
    m).
    """
    arm_weight: FloatArray
    """Change of the load arm per normal approach taken away at each candidate. The sum over the candidates,
    times `Candidates.motion_arm`, is 0. Shape (P, L, m).
    """
    added_arm: FloatArray
    """Arm of a small further load, m. Shape (P, L)."""
    middle: FloatArray
    half: FloatArray
    """`middle`, `half`: Distance of each strip's middle from the touching point, towards tip 1, and half its
    length, m. Shape (P, L, m) each.
    """


def load_arm(pair: ParallelAxes, problem: ContactProblem, solution: ContactSolution) -> FloatArray:
    """Return the arm of the load about the axis of a misalignment (P, L), m."""
    _, moments = _shares(pair, problem.candidates)
    return np.asarray(np.einsum("plm,pm->pl", solution.force, moments) / solution.load)


def _shares(pair: ParallelAxes, c: Candidates) -> FloatArray:
    """Return the shares of the load per unit force, and these shares times the arms in m, (2, P, m)."""
    return c.torque_share * np.stack([np.ones(c.gap.shape), pair.tilt_arm(c.touch.roll_1, c.face_position)])


def adjoint(pair: ParallelAxes, problem: ContactProblem, solution: ContactSolution) -> _Adjoint:
    """Return the weights of all candidates, and the strips, of a solved problem.

    Let S be the decrease of the forces as contacts are moved apart at one deflection, a symmetric matrix, n
    the shares of the load, m the normal approach per deflection and z the arms. Then dF = S (m dSTE - dg)
    where gaps grow by dg, and n'dF = 0. The weights of STE are S n/(n'S m), those of the arm
    (b S n - S (n z))/load, where b is the arm of a small further load.
    """
    c = problem.candidates
    decrease, (middle, half) = (np.zeros((2, *solution.force.shape)) for _ in range(2))
    weigh(point_problems(problem), solution.force, _shares(pair, c), decrease, middle, half)
    decrease[:, solution.status != Status.CONVERGED] = np.nan
    stiffness, moment = np.einsum("rplm,pm->rpl", decrease, c.motion_arm)
    weight, added_arm = decrease[0] / stiffness[..., None], moment / stiffness
    arm_weight = (added_arm[..., None] * decrease[0] - decrease[1]) / solution.load[:, None]
    return _Adjoint(weight, arm_weight, added_arm, middle, half)


@njit(cache=True, error_model="numpy")
def weigh(
    problems: PointProblems,
    force: FloatArray,
    shares: FloatArray,
    decrease: FloatArray,
    middle: FloatArray,
    half: FloatArray,
) -> None:
    """Fill `decrease` (R, P, L, m) with S times rows of `shares` (R, P, m), and the strips; see `adjoint`."""
    count = problems.bodies.shape[0]
    for row in range(count):
        bodies = row_bodies(problems, row)
        for p in range(row, force.shape[0], count):
            problem, touching = problem_on(problems, bodies, p)
            rows = np.ascontiguousarray(shares[:, p][:, touching])
            for k in range(force.shape[1]):
                products = _force_decrease(problem, force[p, k][touching], rows)
                for q in range(touching.size):
                    candidate, carried = touching[q], force[p, k, touching[q]]
                    decrease[:, p, k, candidate] = products[:, q]
                    if carried > 0.0:
                        middle[p, k, candidate], half[p, k, candidate] = carrying_strip(
                            problem.law, q, carried
                        )


@inner(error_model="numpy")
def _force_decrease(problem: PointProblem, force: FloatArray, rows: FloatArray) -> FloatArray:
    """Return the decrease of the forces as contacts are moved apart by rows (R, m), at one deflection.

    It is S = D (1 - N K (1 + N'DN K)^-1 N'D) times the rows, at the forces of a solution.
    """
    state = pressed_state(problem, force)
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
        out[a] = state.slope * (rows[a] - motions(problem, motion))
    return out


def force_changes(problem: ContactProblem, solution: ContactSolution, opened: FloatArray) -> FloatArray:
    """Return the changes of the forces as contacts are moved apart, at the same load.

    Parameters
    ----------
    opened : ndarray, shape (A, P, L, m)
        Normal approach taken away from each candidate by A changes, m. Only candidates that carry count.

    Returns
    -------
    ndarray, shape (A, P, L, m)
        Changes of the forces, N.
    """
    changes = np.zeros(opened.shape)
    _fill_changes(point_problems(problem), solution.force, opened, changes)
    return changes


@njit(cache=True, error_model="numpy")
def _fill_changes(
    problems: PointProblems, force: FloatArray, opened: FloatArray, changes: FloatArray
) -> None:
    """Fill in the changes of the forces at all positions and loads: dF = S (m dSTE - dg), n'dF = 0."""
    count = problems.bodies.shape[0]
    for row in range(count):
        bodies = row_bodies(problems, row)
        for p in range(row, force.shape[0], count):
            problem, touching = problem_on(problems, bodies, p)
            rows = np.empty((len(opened) + 1, touching.size))
            rows[0] = problem.motion_arm
            for k in range(force.shape[1]):
                rows[1:] = opened[:, p, k][:, touching]
                products = _force_decrease(problem, force[p, k][touching], rows)
                stiffness = dot(problem.torque_arm, products[0], touching.size)
                for a in range(len(opened)):
                    lag = dot(problem.torque_arm, products[a + 1], touching.size) / stiffness
                    changes[a, p, k][touching] = lag * products[0] - products[a + 1]
