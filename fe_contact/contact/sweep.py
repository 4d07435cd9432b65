"""Loaded contact over all positions and loads in one compiled call."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.contact.newton import CONVERGED, ITERATION_LIMIT, solve_point
from fe_contact.contact.point_problem import (
    PointProblem,
    PointProblems,
    point_problems,
    problem_on,
    row_bodies,
)
from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.solution_start import Start
from fe_contact.types import BoolArray, FloatArray, IntArray, Status
from host.loops import inner, njit

MOST_STEPS = 16
"""Most steps from one load to the next where Newton's method finds no solution in one."""


@dataclass(frozen=True)
class ContactSolution:
    """Forces, deflection and residuals for P positions, L loads and n contact candidates."""

    load: FloatArray
    """Right-hand side of the equilibrium, T_1/(r_b1 cos beta_b) in N. Shape (L,)."""
    deflection: FloatArray
    """Transmission error in m, positive = the driven gear lags; NaN where `status` is not usable. Shape (P,
    L).
    """
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
    """A contact strip outgrew the load patch of the finite-element model. Shape (P, L)."""
    no_load: FloatArray
    """Deflection at which the first candidate touches, m. Shape (P,)."""

    @property
    def converged(self) -> bool:
        """Whether every point is a solution."""
        return bool(np.all(self.status == Status.CONVERGED))


def solve_contact(problem: ContactProblem, loads: FloatArray, start: Start | None = None) -> ContactSolution:
    """Solve every position at every load.

    Parameters
    ----------
    problem : ContactProblem
        P positions, n candidates.
    loads : ndarray, shape (L,)
        T_1/(r_b1 cos beta_b) in N, increasing and > 0.
    start : Start, optional
        Forces near the solution at every position and load; default: each load starts from the two below it.

    Returns
    -------
    ContactSolution
        Points that did not converge hold NaN and their status; nothing is raised.
    """
    return solve_sets(problem, (loads,), start)[0]


def solve_sets(
    problem: ContactProblem, sets: Sequence[FloatArray], start: Start | None = None
) -> tuple[ContactSolution, ...]:
    """Solve every position at sets of loads, each by itself; see `solve_contact`."""
    problems, c = point_problems(problem), problem.candidates
    p, m, solved = c.position.size, c.pair.size, []
    # forces (P, L, n) to start from; an empty array: none
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
    every: PointProblems,
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
    """Fill the result arrays, started from the `first` forces, or each load from the two below it.

    Forces of a much smaller load press on too few points: where no solution is found from them, the search
    begins again from zero forces, for which `solve_point` guesses a start, and then rises to the load by
    steps. Positions p, p + rows, p + 2 rows and so on have the same compliance of the bodies; they are solved
    one after another, so that it is prepared once.
    """
    rows = every.bodies.shape[0]
    for row in range(rows):
        bodies = row_bodies(every, row)
        for p in range(row, every.gap.shape[0], rows):
            point, touching = problem_on(every, bodies, p)
            start, last = np.zeros(touching.size), np.zeros(touching.size)
            for k in range(loads.size):
                below = 0.0  # load whose forces are `last`
                if first.shape[0] > 0:
                    start = first[p, k][touching]
                elif k > 0:  # extrapolate linearly from the two loads below, the lowest of which is 0
                    before = loads[k - 2] if k > 1 else 0.0
                    part = (loads[k] - loads[k - 1]) / (loads[k - 1] - before)
                    start, last = start + part * (start - last), start
                    below = loads[k - 1] if last.any() else 0.0
                # `solve_point` overwrites `start` with the forces of the solution, and fills the residuals
                d, t, code, count, over = solve_point(point, loads[k], start, residuals[p, k])
                if code != CONVERGED:
                    d, t, code, further, over = _by_steps(
                        point, below, last, loads[k], start, residuals[p, k]
                    )
                    count += further
                status[p, k], iterations[p, k], beyond[p, k] = code, count, over
                if code == CONVERGED:
                    deflection[p, k], tangent[p, k] = d, t
                    force[p, k][touching] = start
                else:
                    start = np.zeros(touching.size)


@inner(error_model="numpy")
def _by_steps(
    point: PointProblem,
    below: float,
    last: FloatArray,
    load: float,
    force: FloatArray,
    residual: FloatArray,
) -> tuple[float, float, int, int, bool]:
    """Solve a point at `load` in N at once from a guess, else by steps from the load `below`.

    `last` are the forces (m,) at that load, zeros at zero load. The forces of each step are the start of the
    next one; there are 2 steps, then 4 and so on, until all converge. Fills `force` with the solution;
    returns what `solve_point` does, with all iterations.
    """
    iterations, steps = 0, 1
    d, t, code, over = math.nan, math.nan, ITERATION_LIMIT, False
    while code != CONVERGED and steps <= MOST_STEPS:
        force[:] = 0.0
        if steps > 1:
            force[:] = last
        for step in range(1, steps + 1):
            level = load if step == steps else below + (load - below) * step / steps
            d, t, code, count, over = solve_point(point, level, force, residual)
            iterations += count
            if code != CONVERGED:
                break
        steps *= 2
    return d, t, code, iterations, over
