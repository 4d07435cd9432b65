"""Loaded contact over all positions and loads in one compiled call."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from fe_contact.contact.local_law import LocalLaw, free_strips
from fe_contact.contact.newton import CONVERGED, solve_point
from fe_contact.contact.point import PointProblem
from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.solution import ContactSolution
from fe_contact.contact.start import Start
from fe_contact.contact.strip import Gap, gap_at, some_gaps
from fe_contact.types import BoolArray, FloatArray, IntArray


def solve_contact(problem: ContactProblem, loads: FloatArray, start: Start | None = None) -> ContactSolution:
    """Solve every position at every load.

    Parameters
    ----------
    problem : ContactProblem
        P positions, n candidates.
    loads : ndarray, shape (L,)
        T_1/(r_b1 cos beta_b) in N, increasing and > 0.
    start : Start, optional
        Forces near the solution at every position and load; default: each load starts from the one below it.

    Returns
    -------
    ContactSolution
        Points that did not converge hold NaN and their status; nothing is raised.
    """
    c = problem.candidates
    p, m, levels = c.position.size, c.pair.size, loads.size
    deflection, tangent = np.full((2, p, levels), np.nan)
    force = np.zeros((p, levels, m))
    status, iterations = np.zeros((2, p, levels), dtype=np.int64)
    residuals = np.zeros((p, levels, 4))
    beyond = np.zeros((p, levels), dtype=np.bool_)
    first_plane, second_plane = problem.half_planes
    modulus = 2.0 / (math.pi * (first_plane + second_plane))
    first = np.zeros((0, 0, m)) if start is None else np.ascontiguousarray(start.on(c))
    _sweep(
        problem.bodies, c.slices.present, c.blend, c.gap * c.motion_arm, c.motion_arm,
        c.torque_share, c.width, c.gap_about, c.slices.law_length, modulus, loads, first,
        deflection, tangent, force, status, iterations, residuals, beyond,
    )  # fmt: skip
    return ContactSolution(
        loads, deflection, tangent, force, status, iterations, residuals, beyond, np.min(c.gap, axis=1)
    )


@njit(cache=True, error_model="numpy")
def _sweep(
    bodies: FloatArray,
    present: BoolArray,
    blend: FloatArray,
    gap: FloatArray,
    motion_arm: FloatArray,
    torque_arm: FloatArray,
    width: FloatArray,
    about: Gap,
    length: float,
    modulus: FloatArray,
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
    """Fill the result arrays, started from the `first` forces, or each load from the one below it."""
    for p in range(gap.shape[0]):
        row = p % bodies.shape[0]
        slices = np.flatnonzero(present[row])
        pairs = np.cumsum(present[row][:: blend.shape[1]]) - 1  # of all pairs among those that are there
        here = np.flatnonzero(~(gap[p] == np.inf))  # also those that are not a number
        points = np.flatnonzero(np.repeat(present[row][:: blend.shape[1]], len(blend)))
        inner = np.ascontiguousarray(bodies[row][slices][:, slices])
        gaps = some_gaps(gap_at(about, p), points)
        local = LocalLaw(width[p][points], gaps, free_strips(gaps), length, modulus[row][points])
        place = pairs[here // len(blend)] * len(blend) + here % len(blend)
        point = PointProblem(
            inner, blend, place, gap[p][here], motion_arm[p][here], torque_arm[p][here], local
        )
        start = np.zeros(here.size)
        for k in range(loads.size):
            if first.shape[0] > 0:
                start = first[p, k][here]
            elif k > 0:
                start *= loads[k] / loads[k - 1]
            d, t, code, count, over = solve_point(point, loads[k], start, residuals[p, k])
            status[p, k], iterations[p, k], beyond[p, k] = code, count, over
            if code == CONVERGED:
                deflection[p, k], tangent[p, k] = d, t
                force[p, k][here] = start
            else:
                start = np.zeros(here.size)
