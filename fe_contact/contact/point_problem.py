"""One position of the contact: the forces of its contacts under given motions of the bodies, compiled.

The terms contact, curve, strip and arm are those of `fe_contact.contact.newton`. Arrays run over P positions,
Q rows of bodies that repeat in further base pitches, n slices and m candidates.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.contact.elimination import copy
from fe_contact.contact.kernel import kernel
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
    curve: FloatArray
    first: IntArray
    """`curve`, `first`: Arrays of `PointProblem` for the points of a pair. Shapes (points, w), (points,)."""
    heights: FloatArray
    """Array of `Candidates`. Shape (K, K)."""
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

    The compiler makes new code for every memory order of every array: in the orders that candidates happen to
    have, it compiled the solver up to eight times, some four seconds each.
    """
    c, rows = problem.candidates, np.ascontiguousarray
    half_planes = problem.half_planes
    curve, first = _banded(c.curves)
    return PointProblems(
        bodies=rows(problem.bodies),
        tilt=rows(problem.rolling),
        radius=rows(problem.radius),
        edge=rows(problem.edges),
        present=rows(c.slices.present),
        curve=curve,
        first=first,
        heights=rows(c.heights),
        gap=rows(c.gap * c.motion_arm),
        motion_arm=rows(c.motion_arm),
        torque_arm=rows(c.torque_share),
        width=rows(c.width),
        about=gap_table(c.gap_about),
        length=float(c.slices.law_length),
        lengths=rows(problem.law_length),
        modulus=rows(2.0 / (math.pi * (half_planes[0] + half_planes[1]))),
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
    """Motion of the strip per tilt of the flanks, m. Shape (n,)."""
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


@inner(error_model="numpy")
def row_bodies(problems: PointProblems, row: int) -> RowBodies:
    """Return the arrays that positions have in common whose bodies are in row `row`, in any base pitch."""
    present = problems.present[row]
    slices = np.flatnonzero(present)
    motion, tilt = problems.bodies[row][slices][:, slices], np.zeros((0, 0))
    motion = _by_curves(problems.heights, _by_curves(problems.heights, motion))
    if problems.tilt.size:
        tilt = _by_curves(
            problems.heights, _by_curves(problems.heights, problems.tilt[row][slices][:, slices])
        )
    return RowBodies(present, motion, tilt)


@inner(error_model="numpy")
def problem_at(problems: PointProblems, p: int) -> tuple[PointProblem, IntArray]:
    """Return the problem of a position, and its contacts among all candidates."""
    return problem_on(problems, row_bodies(problems, p % problems.bodies.shape[0]), p)


@inner(error_model="numpy")
def problem_on(problems: PointProblems, bodies: RowBodies, p: int) -> tuple[PointProblem, IntArray]:
    """Return the problem of a position on the bodies of its row, and its contacts among all candidates."""
    row, points, count = p % problems.bodies.shape[0], problems.first.size, problems.heights.shape[0]
    pairs = np.cumsum(bodies.present[::count]) - 1  # index of each pair among those present
    touching = np.flatnonzero(~(problems.gap[p] == np.inf))  # NaN counts as touching, so as not to be hidden
    radius = problems.radius[p % problems.radius.shape[0]][bodies.present]
    law = local_law(
        problems.about[p][touching],
        problems.width[p][touching],
        problems.modulus[row][touching],
        problems.length,
    )
    law.strip[:, REFERENCE_LENGTH] = problems.lengths[row][touching]
    point = touching % points
    first = pairs[touching // points] * count + problems.first[point]
    arms = problems.motion_arm[p][touching], problems.torque_arm[p][touching]
    edge = problems.edge[p % problems.edge.shape[0]][bodies.present]
    of_bodies = bodies.compliance, bodies.tilt, radius, edge
    gap = problems.gap[p][touching]
    return PointProblem(*of_bodies, problems.curve[point], first, gap, *arms, law), touching


@inner(error_model="numpy")
def _by_curves(heights: FloatArray, motion: FloatArray) -> FloatArray:
    """Return the heights (r, n) of the curves of all pairs for motions (n, r) of their slices, transposed.

    Twice applied, it turns the compliance of slices into that of curves.
    """
    count, curve_heights = heights.shape[0], np.empty(motion.shape)
    for first in range(0, motion.shape[0], count):
        np.dot(heights, motion[first : first + count], curve_heights[first : first + count])
    return np.ascontiguousarray(curve_heights.T)


def _banded(curves: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the values of w neighboring curves at each point (points, w), and the index of the first.

    All other curves are zero at the point.
    """
    count = curves.shape[1]
    nonzero = curves != 0.0
    first, last = nonzero.argmax(axis=1), count - 1 - nonzero[:, ::-1].argmax(axis=1)
    width = int((last - first).max()) + 1
    first = np.minimum(first, count - width)
    return np.take_along_axis(curves, first[:, None] + np.arange(width), axis=1), first


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
    """Return a state with the forces (m,) of the contacts on the curves; displacements are still zero."""
    n, m = problem.bodies.shape[0], force.size
    yielding = np.zeros((n, n)) if problem.tilt.size else problem.bodies  # a constant where no flank rolls
    state = State(np.zeros(n), np.zeros(n), yielding, force, np.zeros(m), np.zeros(n))
    begin(problem, force, state)
    return state


@kernel
def begin(problem: PointProblem, force: FloatArray, state: State) -> None:
    """Fill in a state with the forces (m,) of the contacts on the curves; displacements are zero."""
    copy(force, state.force)
    state.displacement[:] = 0.0
    state.slope[:] = 0.0
    press(problem, force, state.pressed)
    copy(state.pressed, state.curve_load)


@kernel
def evaluate(problem: PointProblem, gap: FloatArray, elastic: float, state: State) -> None:
    """Fill in forces and slopes of the contacts, and the forces on the curves, at the displacements.

    `gap`: Normal gaps (m,), m. `elastic`: Deflection of the driven gear, m.
    """
    for q in range(gap.size):
        motion = motion_at(problem, q, state.displacement)
        approached = problem.motion_arm[q] * elastic - gap[q] - motion
        state.force[q], state.slope[q] = force_at(problem.law, q, approached)
    press(problem, state.force, state.pressed)


@kernel
def press(problem: PointProblem, force: FloatArray, pressed: FloatArray) -> None:
    """Fill `pressed` (n,) with the forces on the curves under forces (m,) of the contacts, N."""
    pressed[:] = 0.0
    for q in range(force.size):
        if force[q] != 0.0:
            for a in range(problem.curve.shape[1]):
                pressed[problem.first[q] + a] += problem.curve[q, a] * force[q]


@kernel
def motion_at(problem: PointProblem, q: int, curve_heights: FloatArray) -> float:
    """Return the motion of the bodies at contact `q` from the heights (n,) of the curves, m."""
    curve, first, value = problem.curve, problem.first[q], 0.0
    for a in range(curve.shape[1]):
        value += curve[q, a] * curve_heights[first + a]
    return value


@kernel
def stiffness(problem: PointProblem, state: State) -> float:
    """Return the growth of the load on the contacts per deflection of the driven gear, N/m."""
    value = 0.0
    for q in range(state.slope.size):
        value += problem.torque_arm[q] * state.slope[q] * problem.motion_arm[q]
    return value
