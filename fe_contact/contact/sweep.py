"""Loaded contact over all positions and loads in one compiled call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.contact.newton import CONVERGED, solve_point
from fe_contact.contact.point_problem import PointProblems, point_problems, problem_on, row_bodies
from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.solution_start import Start
from fe_contact.types import BoolArray, FloatArray, IntArray, Status
from host.loops import njit


@dataclass(frozen=True)
class ContactSolution:
    """Forces, deflection and residuals for P positions, L loads and n contact candidates."""

    load: FloatArray
    """Right-hand side of the equilibrium, T_1/(r_b1 cos beta_b) in N. Shape (L,)."""
    deflection: FloatArray
    """Transmission error in m, positive where the driven gear lags; NaN where not converged. Shape (P, L)."""
    tangent: FloatArray
    """d(deflection)/d(load) in m/N. Shape (P, L)."""
    force: FloatArray
    """Normal force of each candidate in N. Shape (P, L, n)."""
    status: IntArray
    iterations: IntArray
    """`status`, `iterations`: `Status` and Newton iterations. Shape (P, L) each."""
    residuals: FloatArray
    """Equilibrium, penetration, tension and complementarity, each relative (to load or deflection). Shape (P,
    L, 4).
    """
    beyond: BoolArray
    """Whether any strip is wider than the reference length of the local law allows. Shape (P, L)."""
    no_load: FloatArray
    """Deflection at which the first candidate touches, m. Shape (P,)."""

    @property
    def converged(self) -> bool:
        """Whether the contact is solved at all positions and loads."""
        return bool(np.all(self.status == Status.CONVERGED))


def solve_contact(problem: ContactProblem, loads: FloatArray, start: Start | None = None) -> ContactSolution:
    """Solve the contact at each position and load.

    Parameters
    ----------
    problem : ContactProblem
        P positions, n candidates.
    loads : ndarray, shape (L,)
        T_1/(r_b1 cos beta_b) in N, increasing and > 0.
    start : Start, optional
        Forces near the solution at each position and load. By default those of a load are extrapolated from
        the two loads below it.

    Returns
    -------
    ContactSolution
        Where the solution did not converge it has NaN and a `status`; no error is raised.
    """
    return solve_sets(problem, (loads,), start)[0]


def solve_sets(
    problem: ContactProblem, sets: Sequence[FloatArray], start: Start | None = None
) -> tuple[ContactSolution, ...]:
    """Solve each position at sets of loads, each set by itself; see `solve_contact`."""
    problems, c = point_problems(problem), problem.candidates
    p, m, solved = c.position.size, c.pair.size, []
    first = np.zeros((0, 0, m)) if start is None else np.ascontiguousarray(start.on(c))
    for loads in sets:
        deflection, tangent = np.full((2, p, loads.size), np.nan)
        force = np.zeros((p, loads.size, m))
        status, iterations = np.zeros((2, p, loads.size), dtype=np.int64)
        residuals, beyond = np.zeros((p, loads.size, 4)), np.zeros((p, loads.size), dtype=np.bool_)
        results = deflection, tangent, force, status, iterations, residuals, beyond
        _sweep(problems, np.array(loads, dtype=float), first, *results)
        solved.append(ContactSolution(loads, *results, np.min(c.gap, axis=1)))
    return tuple(solved)


@njit(cache=True, error_model="numpy")
def _sweep(
    problems: PointProblems,
    loads: FloatArray,
    first: FloatArray,
    deflection: FloatArray,
    tangent: FloatArray,
    force: FloatArray,
    status: IntArray,
    iterations: IntArray,
    residuals: FloatArray,
    beyond: BoolArray,
) -> None:
    """Fill the result arrays, from the forces `first`, or for each load from those of the two below it.

    Forces of a much smaller load act on too few points: where no solution is found from them, the iteration
    begins again from a guess of `solve_point`. Positions with the same row of bodies are solved in sequence.
    """
    rows = problems.bodies.shape[0]
    for row in range(rows):
        bodies = row_bodies(problems, row)
        for p in range(row, problems.gap.shape[0], rows):
            point, touching = problem_on(problems, bodies, p)
            start, last = np.zeros(touching.size), np.zeros(touching.size)
            for k in range(loads.size):
                if first.shape[0] > 0:
                    start = first[p, k][touching]
                elif k > 0:
                    below = loads[k - 2] if k > 1 else 0.0
                    part = (loads[k] - loads[k - 1]) / (loads[k - 1] - below)
                    start, last = start + part * (start - last), start
                guessed = not start.any()
                d, t, code, count, over = solve_point(point, loads[k], start, residuals[p, k])
                if code != CONVERGED and not guessed:
                    start = np.zeros(touching.size)
                    d, t, code, further, over = solve_point(point, loads[k], start, residuals[p, k])
                    count += further
                status[p, k], iterations[p, k], beyond[p, k] = code, count, over
                if code == CONVERGED:
                    deflection[p, k], tangent[p, k] = d, t
                    force[p, k][touching] = start
                else:
                    start = np.zeros(touching.size)
