"""One position of the contact: the forces of its contacts under given motions of the bodies, compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from fe_contact.contact.local_law import LocalLaw, force_at, free_strips, plain_load, plain_strip
from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.strip import Gap, gap_at
from fe_contact.types import BoolArray, FloatArray, IntArray

# Gaussian elimination with partial pivoting for the small dense systems of the contact, compiled.


@njit(cache=True, fastmath={"reassoc", "contract"})
def dot(x: FloatArray, y: FloatArray, n: int) -> float:
    """Sum of products of the first `n` entries."""
    total = 0.0
    for i in range(n):
        total += x[i] * y[i]
    return total


@njit(cache=True, error_model="numpy")
def eliminate(a: FloatArray, right: FloatArray, n: int) -> bool:
    """Solve a x = right for the leading n x n block; `right` (k, n) holds k right-hand sides, then solutions.

    Returns False, and leaves neither as it was, if the matrix is singular or not finite.
    """
    for j in range(n):
        pivot = j
        for i in range(j + 1, n):
            if abs(a[i, j]) > abs(a[pivot, j]):
                pivot = i
        if not 0.0 < abs(a[pivot, j]) < 1e300:  # false for NaN too
            return False
        if pivot != j:
            _swap(a[j], a[pivot], n)
            for each in right:
                each[j], each[pivot] = each[pivot], each[j]
        for i in range(j + 1, n):
            if a[i, j] != 0.0:
                part = a[i, j] / a[j, j]
                subtract(a[i, j + 1 : n], a[j, j + 1 : n], part)
                for each in right:
                    each[i] -= part * each[j]
    for each in right:
        for i in range(n - 1, -1, -1):
            each[i] = (each[i] - dot(a[i, i + 1 : n], each[i + 1 : n], n - i - 1)) / a[i, i]
    return True


@njit(cache=True, error_model="numpy")
def subtract(x: FloatArray, y: FloatArray, part: float) -> None:
    """Subtract a part of one row from another of the same length."""
    for k in range(x.size):
        x[k] -= part * y[k]


@njit(cache=True, error_model="numpy")
def _swap(x: FloatArray, y: FloatArray, n: int) -> None:
    """Exchange two rows."""
    for k in range(n):
        x[k], y[k] = y[k], x[k]


class PointProblems(NamedTuple):
    """All P positions as the compiled solver reads them; position p has the bodies of row p modulo Q.

    Attributes
    ----------
    bodies : ndarray, shape (Q, n, n)
    present : ndarray of bool, shape (Q, n)
    blend : ndarray, shape (points of a pair, K)
    gap, motion_arm, torque_arm, width : ndarray, shape (P, m)
    about : Gap
        Arrays (P, m) and (P, m, B).
    length : float
    modulus : ndarray, shape (Q, m)
    """

    bodies: FloatArray
    present: BoolArray
    blend: FloatArray
    gap: FloatArray
    motion_arm: FloatArray
    torque_arm: FloatArray
    width: FloatArray
    about: Gap
    length: float
    modulus: FloatArray


def point_problems(problem: ContactProblem) -> PointProblems:
    """Return the positions of a contact problem, row by row in memory.

    Compiled code is made anew for every order of every array: in the order that candidates happen to have,
    the solver was compiled up to eight times, some four seconds each.
    """
    c, rows = problem.candidates, np.ascontiguousarray
    first, second = problem.half_planes
    return PointProblems(
        rows(problem.bodies),
        rows(c.slices.present),
        rows(c.blend),
        rows(c.gap * c.motion_arm),
        rows(c.motion_arm),
        rows(c.torque_share),
        rows(c.width),
        Gap(*map(rows, c.gap_about)),
        float(c.slices.law_length),
        rows(2.0 / (math.pi * (first + second))),
    )


class PointProblem(NamedTuple):
    """One position: m contacts that can carry force, on n = J K slices of J pairs.

    Attributes
    ----------
    bodies : ndarray, shape (n, n)
        Normal approach of slice i per unit normal force on j, without what is in the local law, m/N.
    blend : ndarray, shape (points of a pair, K)
        Parts of the force of each point on the slices of its pair.
    place : ndarray of int, shape (m,)
        Each contact among the points of all pairs.
    gap : ndarray, shape (m,)
        Normal rigid gap in m.
    motion_arm, torque_arm : ndarray, shape (m,)
        Normal approach per unit deflection, and share of the load per unit force; > 0.
    law : LocalLaw
        Of all points of all pairs.
    """

    bodies: FloatArray
    blend: FloatArray
    place: IntArray
    gap: FloatArray
    motion_arm: FloatArray
    torque_arm: FloatArray
    law: LocalLaw


@njit(cache=True, error_model="numpy")
def problem_at(every: PointProblems, p: int) -> tuple[PointProblem, IntArray]:
    """Return the problem of a position, and its contacts among all candidates."""
    row, (points, count) = p % every.bodies.shape[0], every.blend.shape
    there = every.present[row]
    slices = np.flatnonzero(there)
    pairs = np.cumsum(there[::count]) - 1  # of all pairs among those that are there
    here = np.flatnonzero(~(every.gap[p] == np.inf))  # also those that are not a number
    at = np.flatnonzero(np.repeat(there[::count], points))
    inner = np.ascontiguousarray(every.bodies[row][slices][:, slices])
    gaps = gap_at(gap_at(every.about, p), at)
    law = LocalLaw(every.width[p][at], gaps, free_strips(gaps), every.length, every.modulus[row][at])
    slot = pairs[here // points] * points + here % points
    arms = every.motion_arm[p][here], every.torque_arm[p][here]
    return PointProblem(inner, every.blend, slot, every.gap[p][here], *arms, law), here


class State(NamedTuple):
    """The state of an iteration.

    Attributes
    ----------
    held : ndarray, shape (n,)
        Forces on the slices h, N.
    moved : ndarray, shape (n,)
        What they move, K h, m.
    force, slope : ndarray, shape (m,)
        Of the contacts under these motions: N, N/m.
    pressed : ndarray, shape (n,)
        Those forces on the slices N'F, N.
    """

    held: FloatArray
    moved: FloatArray
    force: FloatArray
    slope: FloatArray
    pressed: FloatArray


@njit(cache=True, error_model="numpy")
def evaluate(problem: PointProblem, gap: FloatArray, elastic: float, state: State) -> None:
    """Fill in forces and slopes of the contacts, and the forces on the slices, under the motions."""
    points, count = problem.blend.shape
    slot, blend, moved, arm = problem.place, problem.blend, state.moved, problem.motion_arm
    width, curvature, free = problem.law.width, problem.law.gap.curvature, problem.law.free
    length, modulus = problem.law.length, problem.law.modulus
    for q in range(gap.size):
        closer = arm[q] * elastic - gap[q]
        state.force[q], state.slope[q] = 0.0, 0.0
        i = slot[q]
        first, row = i // points * count, i % points
        for a in range(count):
            closer -= blend[row, a] * moved[first + a]
        if closer <= 0.0:
            continue
        half = plain_strip(curvature[i], length, closer)
        if half <= free[i]:
            line_load, stiffness = plain_load(curvature[i], length, modulus[i], half, closer)
            state.force[q], state.slope[q] = width[i] * line_load, width[i] * stiffness
        else:
            state.force[q], state.slope[q] = force_at(problem.law, i, closer)
    press(problem, state.force, state.pressed)


@njit(cache=True, error_model="numpy")
def press(problem: PointProblem, force: FloatArray, out: FloatArray) -> None:
    """Fill in the forces of the contacts on the slices."""
    points, count = problem.blend.shape
    slot, blend = problem.place, problem.blend
    out[:] = 0.0
    for q in range(force.size):
        if force[q] != 0.0:
            first, row = slot[q] // points * count, slot[q] % points
            for a in range(count):
                out[first + a] += blend[row, a] * force[q]


@njit(cache=True, error_model="numpy")
def move(problem: PointProblem, held: FloatArray, out: FloatArray) -> None:
    """Fill in the motions of the slices under forces on them."""
    for j in range(held.size):
        out[j] = dot(problem.bodies[j], held, held.size)


@njit(cache=True, error_model="numpy")
def motion_at(problem: PointProblem, q: int, moved: FloatArray) -> float:
    """Return the motion of the bodies at a contact, m."""
    points, count = problem.blend.shape
    first, row = problem.place[q] // points * count, problem.place[q] % points
    value = 0.0
    for a in range(count):
        value += problem.blend[row, a] * moved[first + a]
    return value


@njit(cache=True, error_model="numpy")
def stiffness(problem: PointProblem, state: State) -> float:
    """Return how fast the contacts take load as the gear moves, N/m."""
    value = 0.0
    for q in range(state.slope.size):
        value += problem.torque_arm[q] * state.slope[q] * problem.motion_arm[q]
    return value
