"""Loaded contact over all positions and loads in one compiled call."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from fe_contact.contact.local_law import local_law
from fe_contact.contact.newton import CONVERGED, PointProblem, solve_point
from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.solution import ContactSolution
from fe_contact.contact.start import Start
from fe_contact.contact.strip import Gap, gap_at
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
    p, n, levels = c.position.size, c.pair.size, loads.size
    deflection, tangent = np.full((2, p, levels), np.nan)
    force = np.zeros((p, levels, n))
    status, iterations = np.zeros((2, p, levels), dtype=np.int64)
    residuals = np.zeros((p, levels, 4))
    beyond = np.zeros((p, levels), dtype=np.bool_)
    normal_gap = c.gap * c.motion_arm
    first = np.zeros((0, 0, n)) if start is None else np.ascontiguousarray(start.on(c))
    _sweep(
        problem.compliance, normal_gap, c.motion_arm, c.torque_share,
        c.gap_about, np.full(n, c.width), c.patch_1.law_width, c.patch_2.law_width,
        *problem.half_planes, loads, first,
        deflection, tangent, force, status, iterations, residuals, beyond,
    )  # fmt: skip
    return ContactSolution(
        loads, deflection, tangent, force, status, iterations, residuals, beyond, np.min(c.gap, axis=1)
    )


@njit(cache=True)
def _sweep(
    compliance: FloatArray,
    gap: FloatArray,
    motion_arm: FloatArray,
    torque_arm: FloatArray,
    about: Gap,
    width: FloatArray,
    patch_1: FloatArray,
    patch_2: FloatArray,
    half_plane_1: FloatArray,
    half_plane_2: FloatArray,
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
        k1, k2 = half_plane_1[p], half_plane_2[p]
        modulus = 2.0 / (math.pi * (k1 + k2))
        law = local_law(gap_at(about, p), width, patch_1[p], patch_2[p], modulus, k1, k2)
        point = PointProblem(compliance[p % compliance.shape[0]], gap[p], motion_arm[p], torque_arm[p], law)
        start = np.zeros(gap.shape[1])
        for k in range(loads.size):
            if first.shape[0] > 0:
                start = first[p, k].copy()
            elif k > 0:
                start *= loads[k] / loads[k - 1]
            d, t, code, count, over = solve_point(point, loads[k], start, residuals[p, k])
            status[p, k], iterations[p, k], beyond[p, k] = code, count, over
            if code == CONVERGED:
                deflection[p, k], tangent[p, k] = d, t
                force[p, k] = start
            else:
                start = np.zeros(gap.shape[1])
