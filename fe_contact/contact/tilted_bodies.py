"""Motions of the bodies under forces, where tilted flanks move the points of application; compiled."""

from __future__ import annotations

from fe_contact.contact.edge_strip import SIDE, edge_motion
from fe_contact.contact.elimination import dot, subtract
from fe_contact.contact.kernel import kernel
from fe_contact.contact.point_problem import PointProblem, State
from fe_contact.types import FloatArray


@kernel
def move(problem: PointProblem, state: State) -> None:
    """Fill in the heights of the curves under the forces on them, u(h).

    It is the gradient of the energy h'K h/2 + sum_j h_j min_y (y t_j + y^2/(2 R_j)) with the tilts t = D h.
    Flanks that tilt press at a distance y from where they would touch otherwise, no further away than the
    reference length. Near an edge y and the motion of the corner are those of
    `fe_contact.contact.edge_strip`.
    """
    n = state.curve_load.size
    for j in range(n):
        state.displacement[j] = dot(problem.bodies[j], state.curve_load, n)
    for j in range(n):
        if problem.edge[j, SIDE] != 0.0:
            tilt = dot(problem.tilt[j], state.curve_load, n)
            motion = edge_motion(problem.edge, j, state.curve_load[j], tilt)
            state.displacement[j] += motion.by_force + motion.corner
            for k in range(n):
                state.displacement[k] += problem.tilt[j, k] * motion.by_tilt
        elif problem.radius[j] > 0.0:
            tilt, way, _ = rolled(problem, j, state.curve_load)
            state.displacement[j] += way * (tilt + 0.5 * way / problem.radius[j])
            for k in range(n):
                state.displacement[k] += problem.tilt[j, k] * way * state.curve_load[j]


@kernel
def rolled(problem: PointProblem, j: int, pressed: FloatArray) -> tuple[float, float, float]:
    """Return the tilt of the flanks at a curve, the motion of their strip in m, and that per tilt."""
    tilt, radius = dot(problem.tilt[j], pressed, pressed.size), problem.radius[j]
    way = min(max(-radius * tilt, -problem.law.length), problem.law.length)
    return tilt, way, -radius if abs(way) < problem.law.length else 0.0


@kernel
def fill_yielding(problem: PointProblem, state: State) -> None:
    """Fill in the derivative of the displacement in the forces; it is constant where no flank rolls."""
    if not problem.tilt.size:
        return
    n, out = state.curve_load.size, state.yielding
    for j in range(n):
        for k in range(n):
            out[j, k] = problem.bodies[j, k]
    for j in range(n):
        row, mixed, square = problem.tilt[j], 0.0, 0.0
        if problem.edge[j, SIDE] != 0.0:
            motion = edge_motion(problem.edge, j, state.curve_load[j], dot(row, state.curve_load, n))
            out[j, j] += motion.force_force + motion.softness
            mixed, square = motion.force_tilt, motion.tilt_tilt
        elif problem.radius[j] > 0.0:
            _, mixed, rate = rolled(problem, j, state.curve_load)
            square = rate * state.curve_load[j]
        if mixed != 0.0:
            for k in range(n):
                out[j, k] += mixed * row[k]
                out[k, j] += mixed * row[k]
        if square != 0.0:
            for k in range(n):
                subtract(out[k], row, -square * row[k])


@kernel
def yield_to(yielding: FloatArray, change: FloatArray, out: FloatArray) -> None:
    """Fill `out` with the change of the heights of the curves by small changes of the forces."""
    for j in range(change.size):
        out[j] = dot(yielding[j], change, change.size)
