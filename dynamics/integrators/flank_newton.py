"""Compiled Newton's method for the flank forces of one implicit stage.

Everything but the flanks is linear, and each flank acts along one direction, so the stage's n equations
reduce to one scalar unknown per flank: its force.
"""

from __future__ import annotations

from dynamics.forces.compiled import inner
from dynamics.forces.flank_force import flank_force
from dynamics.integrators.workspace import Workspace
from dynamics.system.arrays import SystemArrays
from dynamics.types import FloatArray

ITERATION_LIMIT = 25


@inner
def solve_flanks(system: SystemArrays, work: Workspace, rung: int, span: float, tolerance: float) -> int:
    """Find ``work.force`` such that each force is its law's at the motion it causes; return the iterations.

    On entry position, deflection and rate are those without flank forces, and ``work.force`` is a first
    guess; on exit they include the forces. A force F of flank f changes the deflection of flank e by -span^2
    approach[e, f] F, its rate by -span ... F. The change of the position with the force is followed but left
    out of the Jacobian: it is of the order of a deflection over a base pitch. Returns -1 if the last update
    was not below `tolerance` (N).
    """
    flanks = work.force.size
    for iteration in range(ITERATION_LIMIT):
        for e in range(flanks):
            moved, turned = 0.0, 0.0
            for f in range(flanks):
                moved += work.approach[rung, e, f] * work.force[f]
                turned += work.turning[rung, e, f] * work.force[f]
            force, work.elastic[e], tangent, viscous, work.hint[e] = flank_force(
                system.flank,
                e,
                work.position[e] - span * span * turned,
                work.deflection[e] - span * span * moved,
                work.rate[e] - span * moved,
                work.hint[e],
            )
            gain = span * (span * tangent + viscous)
            for f in range(flanks):
                work.jacobian[e, f] = gain * work.approach[rung, e, f]
            work.jacobian[e, e] += 1.0
            work.jacobian[e, flanks] = force - work.force[e]
        if update_forces(work.jacobian, work.force) <= tolerance:
            _settle(work, rung, span)
            return iteration + 1
    return -1


@inner
def _settle(work: Workspace, rung: int, span: float) -> None:
    """Let the forces found act on positions, deflections and rates."""
    for e in range(work.force.size):
        for f in range(work.force.size):
            push = span * work.force[f]
            work.position[e] -= span * push * work.turning[rung, e, f]
            work.deflection[e] -= span * push * work.approach[rung, e, f]
            work.rate[e] -= push * work.approach[rung, e, f]


@inner
def update_forces(jacobian: FloatArray, force: FloatArray) -> float:
    """Solve the augmented system (m, m + 1) with row pivoting, add to `force`, return the largest update."""
    size, largest = force.size, 0.0
    for p in range(size):
        best = p
        for i in range(p + 1, size):
            if abs(jacobian[i, p]) > abs(jacobian[best, p]):
                best = i
        for j in range(p, size + 1):
            jacobian[p, j], jacobian[best, j] = jacobian[best, j], jacobian[p, j]
        for i in range(p + 1, size):
            factor = jacobian[i, p] / jacobian[p, p]
            for j in range(p + 1, size + 1):
                jacobian[i, j] -= factor * jacobian[p, j]
    for p in range(size - 1, -1, -1):
        for j in range(p + 1, size):
            jacobian[p, size] -= jacobian[p, j] * jacobian[j, size]
        jacobian[p, size] /= jacobian[p, p]
        force[p] += jacobian[p, size]
        largest = max(largest, abs(jacobian[p, size]))
    return largest
