"""Laws that a solution must keep, checked on the displacements of all nodes: reactions and energy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fe_contact.full_contact.condensation.condensed_body import CondensedBody
from fe_contact.full_contact.condensation.linearized_contact import Solution
from fe_contact.types import FloatArray

Bodies = tuple[CondensedBody, CondensedBody]


def bore_checks(bodies: Bodies, solutions: Sequence[Solution]) -> list[tuple[float, float]]:
    """Return the largest relative breach of the laws, and the torque of gear 2 over that of gear 1.

    The moment of the reactions at gear 1's bore is the torque, at gear 2's bore that of the contact forces;
    the work u f of both gears is p C p. Nothing condensed enters the reactions: all nodes are solved for.
    """
    reactions, work = zip(*(_of_body(bodies, number, solutions) for number in range(2)), strict=True)
    checks = []
    for i, (contact, pressure, torque) in enumerate(solutions):
        driven = _moment(bodies[1], contact.forces[1] @ pressure)
        balance = max(abs(float(reactions[0][i]) / torque + 1.0), abs(float(reactions[1][i]) / driven + 1.0))
        elastic = float(pressure @ contact.system.compliance @ pressure)
        energy = abs(float(work[0][i] + work[1][i]) / elastic - 1.0)
        checks.append((max(balance, energy), abs(driven) / torque))
    return checks


def _of_body(bodies: Bodies, number: int, solutions: Sequence[Solution]) -> tuple[FloatArray, FloatArray]:
    """Return the moments of the bore's reactions about the center, and the work of the forces, (T,)."""
    body = bodies[number]
    forces = np.zeros((body.stiffness.shape[0], len(solutions)))
    for i, (contact, pressure, _) in enumerate(solutions):
        forces[body.freedoms, i] = contact.forces[number] @ pressure
    moved = body.solve(forces)
    held = body.body.held
    reactions = np.asarray(body.stiffness @ moved).reshape(-1, 2, len(solutions))[held]
    arms = body.body.points[held] - body.body.center
    moments = arms[:, 0] @ reactions[:, 1] - arms[:, 1] @ reactions[:, 0]
    return moments, np.sum(moved * forces, axis=0)


def _moment(body: CondensedBody, forces: FloatArray) -> float:
    """Return the moment of forces (2 k,) on the strips' nodes about the gear's center, counter-clockwise."""
    arms = body.points - body.body.center
    return float(arms[:, 0] @ forces[1::2] - arms[:, 1] @ forces[0::2])
