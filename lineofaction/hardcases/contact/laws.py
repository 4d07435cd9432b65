"""Laws of every contact scene: the conditions of contact, and a second solver that agrees."""

from __future__ import annotations

import numpy as np

from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.contact.point_problem import motion_at, point_problems, pressed_state, problem_at
from fe_contact.contact.tilted_bodies import fill_yielding, move
from fe_contact.types import FloatArray
from lineofaction.hardcases.contact.interior_point import GapAbout, Problem, solve
from lineofaction.hardcases.scene import Measured

LARGEST_RESIDUAL = 1e-9
MAX_ITERATIONS = 40
LARGEST_DISAGREEMENT = 1e-8
COMPARED = 12
"""Points that the second solver solves too: it is ten thousand times as slow."""


def soundness(
    problem: ContactProblem, solution: ContactSolution, compared: int = COMPARED
) -> tuple[Measured, ...]:
    """Return failed points, worst residual, most iterations, and the disagreement of two solvers.

    The second one (`interior_point`) shares no line with the first, not even the local law. `compared`
    points are spread evenly over positions and loads.
    """
    total = solution.status.size
    chosen = np.unique(np.linspace(0, total - 1, min(compared, total)).astype(int))
    points = [tuple(map(int, np.unravel_index(i, solution.status.shape))) for i in chosen]
    differences = [_disagreement(problem, solution, position, load) for position, load in points]
    return (
        Measured("failed points", (solution.status != 0).sum(), maximum=0.0),
        Measured("largest residual", solution.residuals.max(), maximum=LARGEST_RESIDUAL),
        Measured("most iterations", solution.iterations.max(), maximum=MAX_ITERATIONS),
        Measured("two solvers apart", max(differences), maximum=LARGEST_DISAGREEMENT),
    )


def _disagreement(problem: ContactProblem, solution: ContactSolution, position: int, load: int) -> float:
    """Return the difference of both solvers' deflection over the elastic deflection."""
    answer = solve(_plain(problem, position, solution.force[position, load]), float(solution.load[load]))
    deflection = float(solution.deflection[position, load])
    return abs(answer.deflection - deflection) / (deflection - float(solution.no_load[position]))


def _plain(problem: ContactProblem, position: int, force: FloatArray) -> Problem:
    """Return one position as a problem of the second solver, without entries that are no candidates there.

    Bodies that tilt yield as they do under the `force` that is to be confirmed.
    """
    c = problem.candidates
    point, candidates = problem_at(point_problems(problem), position)
    state = pressed_state(point, force[candidates])
    move(point, state)
    fill_yielding(point, state)
    # (contacts, curve heights): the matrix of the linear map from heights to motions
    units = np.eye(len(point.bodies))
    blend = np.array([[motion_at(point, q, unit) for unit in units] for q in range(point.gap.size)])
    real = np.isin(np.arange(c.pair.size), candidates)
    motion = c.motion_arm[position, real]
    row = position % len(problem.compliance)
    return Problem(
        compliance=blend @ state.yielding @ blend.T,
        gap=c.gap[position, real] * motion + blend @ (state.displacement - state.yielding @ state.curve_load),
        motion_arm=motion,
        torque_arm=c.torque_share[position, real],
        gap_about=GapAbout(*(part[position, real] for part in c.gap_about)),
        width=c.width[position, real],
        length=c.slices.law_length,
        reference_length=problem.law_length[row, real],
        modulus=2.0 / (np.pi * sum(k[row, real] for k in problem.half_planes)),
    )
