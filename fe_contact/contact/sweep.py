"""Loaded contact over all positions and loads in one compiled call."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fe_contact.contact.elimination import any_nonzero, copy
from fe_contact.contact.kernel import kernel
from fe_contact.contact.newton import (
    CONVERGED,
    ITERATION_LIMIT,
    NewtonSystem,
    empty_system,
    solve_in,
)
from fe_contact.contact.point_problem import (
    PointProblem,
    PointProblems,
    State,
    point_problems,
    pressed_state,
    problem_on,
    row_bodies,
)
from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.solution_start import Start
from fe_contact.types import BoolArray, FloatArray, IntArray, Status
from host.loops import njit

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
        status, iterations = np.zeros((2, p, loads.size), dtype=np.int64)
        results = _Results(
            deflection=deflection,
            tangent=tangent,
            force=np.zeros((p, loads.size, m)),
            status=status,
            iterations=iterations,
            residuals=np.zeros((p, loads.size, 4)),
            beyond=np.zeros((p, loads.size), dtype=np.bool_),
        )
        _sweep(problems, np.array(loads, dtype=float), first, results)
        solved.append(ContactSolution(loads, *results, np.min(c.gap, axis=1)))
    return tuple(solved)


class _Results(NamedTuple):
    """The arrays of `ContactSolution` from `deflection` to `beyond`, which the sweep fills in."""

    deflection: FloatArray
    tangent: FloatArray
    force: FloatArray
    status: IntArray
    iterations: IntArray
    residuals: FloatArray
    beyond: BoolArray


class _Search(NamedTuple):
    """Arrays of one position that the solutions of its loads use one after the other."""

    start: FloatArray
    """Forces of the contacts to start from, then those of the solution, N. Shape (m,)."""
    last: FloatArray
    """Forces at the load below, zeros at the lowest load, N. Shape (m,)."""
    state: State
    system: NewtonSystem


@njit(cache=True, error_model="numpy")
def _sweep(every: PointProblems, loads: FloatArray, first: FloatArray, results: _Results) -> None:
    """Fill the result arrays, started from the `first` forces, or each load from the two below it.

    Positions p, p + rows, p + 2 rows and so on have the same compliance of the bodies; they are solved one
    after another, so that it is prepared once.
    """
    rows = every.bodies.shape[0]
    for row in range(rows):
        bodies = row_bodies(every, row)
        for p in range(row, every.gap.shape[0], rows):
            point, touching = problem_on(every, bodies, p)
            start, last = np.zeros(touching.size), np.zeros(touching.size)
            state = pressed_state(point, np.zeros(touching.size))
            search = _Search(start, last, state, empty_system(point))
            for k in range(loads.size):
                below = 0.0  # load whose forces are `last`
                if first.shape[0] > 0:
                    for q in range(touching.size):
                        start[q] = first[p, k, touching[q]]
                elif k > 0:
                    below = _extrapolated(loads, k, search)
                _solve(point, touching, (p, k), loads[k], below, search, results)


@kernel
def _extrapolated(loads: FloatArray, k: int, search: _Search) -> float:
    """Start load `k` on the line through the two below it; return the load below, zero without forces.

    The load below the lowest one is zero.
    """
    before = loads[k - 2] if k > 1 else 0.0
    part = (loads[k] - loads[k - 1]) / (loads[k - 1] - before)
    for q in range(search.start.size):
        force = search.start[q]
        search.start[q], search.last[q] = force + part * (force - search.last[q]), force
    return float(loads[k - 1]) if any_nonzero(search.last) else 0.0


@kernel
def _solve(
    point: PointProblem,
    touching: IntArray,
    at: tuple[int, int],
    load: float,
    below: float,
    search: _Search,
    results: _Results,
) -> None:
    """Solve a position at a load, and enter the solution of the contacts `touching` into the results.

    Forces of a much smaller load press on too few points: where no solution is found from them, the search
    begins again from zero forces, for which `solve_in` guesses a start, and then rises to the load by steps.

    Parameters
    ----------
    at : (int, int)
        Indices of position and load.
    below : float
        Load in N of the forces `search.last`.
    """
    p, k = at
    start, residual = search.start, results.residuals[p, k]
    # `solve_in` overwrites `start` with the forces of the solution, and fills the residuals
    d, t, code, count, over = solve_in(point, load, start, residual, search.state, search.system)
    if code != CONVERGED:
        d, t, code, further, over = _by_steps(point, below, load, residual, search)
        count += further
    results.status[p, k], results.iterations[p, k], results.beyond[p, k] = code, count, over
    if code == CONVERGED:
        results.deflection[p, k], results.tangent[p, k] = d, t
        for q in range(touching.size):
            results.force[p, k, touching[q]] = start[q]
    else:
        start[:] = 0.0


@kernel
def _by_steps(
    point: PointProblem, below: float, load: float, residual: FloatArray, search: _Search
) -> tuple[float, float, int, int, bool]:
    """Solve a point at `load` in N at once from a guess, else by steps from the load `below`.

    `search.last` are the forces (m,) at that load, zeros at zero load. The forces of each step are the start
    of the next one; there are 2 steps, then 4 and so on, until all converge. Fills `search.start` with the
    solution; returns what `solve_in` does, with all iterations.
    """
    force, iterations, steps = search.start, 0, 1
    d, t, code, over = math.nan, math.nan, ITERATION_LIMIT, False
    while code != CONVERGED and steps <= MOST_STEPS:
        force[:] = 0.0
        if steps > 1:
            copy(search.last, force)
        for step in range(1, steps + 1):
            level = load if step == steps else below + (load - below) * step / steps
            d, t, code, count, over = solve_in(point, level, force, residual, search.state, search.system)
            iterations += count
            if code != CONVERGED:
                break
        steps *= 2
    return d, t, code, iterations, over
