"""One position of the contact: the forces of its contacts under given motions of the bodies, compiled.

The terms contact, curve, strip and arm are those of `fe_contact.contact.newton`. Arrays run over P positions,
Q rows of bodies that repeat in further base pitches, n slices and m candidates.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.contact.local_law import REFERENCE_LENGTH, LocalLaw, force_at, local_law
from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.strip import gap_table
from fe_contact.types import BoolArray, FloatArray, IntArray
from host.loops import inner


class PointProblems(NamedTuple):
    """Contact problems of P positions for the compiled solver; position p has bodies p modulo Q."""

    bodies: FloatArray
    tilt: FloatArray
    """`bodies`, `tilt`: Arrays of `PointProblem` of all slices; the tilt is empty where flanks do not roll.
    Shape (Q, n, n) each.
    """
    radius: FloatArray
    """Array `radius` of `PointProblem`. Shape (P, n) where flanks roll, else (Q, n)."""
    edge: FloatArray
    """Tables of `EdgeStrips`. Shape (Q, n, 8) where flanks roll, else (1, n, 8)."""
    present: BoolArray
    """Whether any contact can press on a slice. Shape (Q, n)."""
    curves: FloatArray
    heights: FloatArray
    """`curves`, `heights`: Arrays of `Candidates`. Shapes (points of a pair, K), (K, K)."""
    gap: FloatArray
    motion_arm: FloatArray
    torque_arm: FloatArray
    width: FloatArray
    """`gap`, `motion_arm`, `torque_arm`, `width`: Arrays of `Candidates`. Shape (P, m) each."""
    about: FloatArray
    """Gap about the touching points, a `gap_table`. Shape (P, m, 4 + 3 B)."""
    length: float
    """Reference length away from free ends, m."""
    lengths: FloatArray
    modulus: FloatArray
    """`lengths`, `modulus`: Reference length, m, and contact modulus, Pa, under each candidate. Shape (Q, m)
    each.
    """


def point_problems(problem: ContactProblem) -> PointProblems:
    """Return the positions of a contact problem, row by row in memory.

    Compiled code is made anew for every order of every array: in the order that candidates happen to have,
    the solver was compiled up to eight times, some four seconds each.
    """
    c, rows = problem.candidates, np.ascontiguousarray
    first, second = problem.half_planes
    return PointProblems(
        rows(problem.bodies),
        rows(problem.rolling),
        rows(problem.radius),
        rows(problem.edges),
        rows(c.slices.present),
        rows(c.curves),
        rows(c.heights),
        rows(c.gap * c.motion_arm),
        rows(c.motion_arm),
        rows(c.torque_share),
        rows(c.width),
        gap_table(c.gap_about),
        float(c.slices.law_length),
        rows(problem.law_length),
        rows(2.0 / (math.pi * (first + second))),
    )


class PointProblem(NamedTuple):
    """One position: m contacts that can carry force, on n = J K curves of J pairs."""

    bodies: FloatArray
    """Height of curve i per unit force on j without the compliance of the local law, m/N. Shape (n, n)."""
    tilt: FloatArray
    """Tilt of the flanks at curve i per unit force on j, 1/N; see `ContactProblem`. Ndarray, shape (n, n), or
    (0, 0) where no radius is above zero.
    """
    radius: FloatArray
    """Way of the strip per tilt of the flanks, m. Shape (n,)."""
    edge: FloatArray
    """Tables of `EdgeStrips`. Shape (n, 8)."""
    curve: FloatArray
    """Shares of the force of each contact on w neighboring curves, and of the height of these curves at the
    contact. Shape (m, w).
    """
    first: IntArray
    """Index of the first of the w curves. Shape (m,)."""
    gap: FloatArray
    """Normal rigid gap in m. Shape (m,)."""
    motion_arm: FloatArray
    torque_arm: FloatArray
    """`motion_arm`, `torque_arm`: Normal approach per unit deflection, and share of the load per unit force;
    > 0. Shape (m,) each.
    """
    law: LocalLaw


class RowBodies(NamedTuple):
    """Arrays that all problems of one row of bodies have in common."""

    present: BoolArray
    """Slices that any contact can press on. Shape (n,)."""
    compliance: FloatArray
    tilt: FloatArray
    """`compliance`, `tilt`: Arrays `bodies` and `tilt` of `PointProblem`, for all slices of `present`."""
    curve: FloatArray
    first: IntArray
    """`curve`, `first`: Arrays of `PointProblem` for the points of one pair. Shapes (points, w), (points,).
    """


@inner(error_model="numpy")
def row_bodies(every: PointProblems, row: int) -> RowBodies:
    """Return the arrays that all positions of row `row` share, in any base pitch."""
    present = every.present[row]
    slices = np.flatnonzero(present)
    motion, tilt = every.bodies[row][slices][:, slices], np.zeros((0, 0))
    motion = _turned(every.heights, _turned(every.heights, motion))
    if every.tilt.size:
        tilt = _turned(every.heights, _turned(every.heights, every.tilt[row][slices][:, slices]))
    curve, first = _banded(every.curves)
    return RowBodies(present, motion, tilt, curve, first)


@inner(error_model="numpy")
def problem_at(every: PointProblems, p: int) -> tuple[PointProblem, IntArray]:
    """Return the problem of a position, and its contacts among all candidates."""
    return problem_on(every, row_bodies(every, p % every.bodies.shape[0]), p)


@inner(error_model="numpy")
def problem_on(every: PointProblems, bodies: RowBodies, p: int) -> tuple[PointProblem, IntArray]:
    """Return the problem of a position on the bodies of its row, and its contacts among all candidates."""
    row, (points, count) = p % every.bodies.shape[0], every.curves.shape
    pairs = np.cumsum(bodies.present[::count]) - 1  # number of each pair among those present
    touching = np.flatnonzero(~(every.gap[p] == np.inf))  # also those that are not a number
    radius = every.radius[p % every.radius.shape[0]][bodies.present]
    law = local_law(
        every.about[p][touching], every.width[p][touching], every.modulus[row][touching], every.length
    )
    law.strip[:, REFERENCE_LENGTH] = every.lengths[row][touching]
    point = touching % points
    first = pairs[touching // points] * count + bodies.first[point]
    arms = every.motion_arm[p][touching], every.torque_arm[p][touching]
    edge = every.edge[p % every.edge.shape[0]][bodies.present]
    of_bodies = bodies.compliance, bodies.tilt, radius, edge
    return PointProblem(*of_bodies, bodies.curve[point], first, every.gap[p][touching], *arms, law), touching


@inner(error_model="numpy")
def _turned(heights: FloatArray, motion: FloatArray) -> FloatArray:
    """Return the heights (r, n) of the curves of all pairs for motions (n, r) of their slices."""
    count, turned = heights.shape[0], np.empty(motion.shape)
    for first in range(0, motion.shape[0], count):
        np.dot(heights, motion[first : first + count], turned[first : first + count])
    return np.ascontiguousarray(turned.T)


@inner(error_model="numpy")
def _banded(curves: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the curves (points, w) that are not zero at each point, and which is the first of them."""
    points, count = curves.shape
    first, width = np.zeros(points, dtype=np.int64), 1
    for i in range(points):
        nonzero = np.flatnonzero(curves[i])
        first[i], width = nonzero[0], max(width, nonzero[-1] - nonzero[0] + 1)
    first = np.minimum(first, count - width)
    columns = np.empty((points, width))
    for i in range(points):
        columns[i] = curves[i, first[i] : first[i] + width]
    return columns, first


class State(NamedTuple):
    """State of an iteration: forces and displacements of the n curves, and forces of the m contacts."""

    curve_load: FloatArray
    """Forces on the curves h, N. Shape (n,)."""
    displacement: FloatArray
    """Displacement of the curves by these forces, u(h), m. Shape (n,)."""
    yielding: FloatArray
    """Derivative of the displacement in the forces, m/N. Shape (n, n)."""
    force: FloatArray
    slope: FloatArray
    """`force`, `slope`: Forces of the contacts under these displacements, N, and their derivatives, N/m.
    Shape (m,) each.
    """
    pressed: FloatArray
    """Forces of the contacts on the curves, N'F, N. Shape (n,)."""


@inner(error_model="numpy")
def pressed_state(problem: PointProblem, force: FloatArray) -> State:
    """Return a state with the forces (m,) of the contacts on the curves; what they move is still missing."""
    n, m = problem.bodies.shape[0], force.size
    yielding = np.zeros((n, n)) if problem.tilt.size else problem.bodies  # it stays where no flank rolls
    state = State(np.zeros(n), np.zeros(n), yielding, force, np.zeros(m), np.zeros(n))
    press(problem, force, state.pressed)
    state.curve_load[:] = state.pressed
    return state


@inner(error_model="numpy")
def evaluate(problem: PointProblem, gap: FloatArray, elastic: float, state: State) -> None:
    """Fill in forces and slopes of the contacts, and the forces on the curves, under the motions."""
    law, arm, motion = problem.law, problem.motion_arm, motions(problem, state.displacement)
    for q in range(gap.size):
        state.force[q], state.slope[q] = force_at(law, q, arm[q] * elastic - gap[q] - motion[q])
    press(problem, state.force, state.pressed)


@inner(error_model="numpy")
def press(problem: PointProblem, force: FloatArray, out: FloatArray) -> None:
    """Fill in the forces of the contacts on the curves."""
    out[:] = 0.0
    for q in range(force.size):
        if force[q] != 0.0:
            for a in range(problem.curve.shape[1]):
                out[problem.first[q] + a] += problem.curve[q, a] * force[q]


@inner(error_model="numpy")
def motions(problem: PointProblem, of_slices: FloatArray) -> FloatArray:
    """Return the motions of the bodies at the contacts (m,) from those of the curves, m."""
    curve, first, out = problem.curve, problem.first, np.empty(problem.first.size)
    for q in range(out.size):
        value = 0.0
        for a in range(curve.shape[1]):
            value += curve[q, a] * of_slices[first[q] + a]
        out[q] = value
    return out


@inner(error_model="numpy")
def stiffness(problem: PointProblem, state: State) -> float:
    """Return how fast the contacts take load as the gear moves, N/m."""
    value = 0.0
    for q in range(state.slope.size):
        value += problem.torque_arm[q] * state.slope[q] * problem.motion_arm[q]
    return value
