"""The contact solver in the receipt: how hard the points were, and which failed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from fe_contact.analysis.estimates.error_sources import worst_residual
from fe_contact.analysis.request.solved_run import Solved
from fe_contact.contact import ContactSolution
from fe_contact.contact.condition_number import condition_numbers
from fe_contact.types import FloatArray, Json, Status

FEW_ITERATIONS = 40
"""Usual limit of the iterations of a point. The receipt counts the points that need more."""


def contact_receipt(
    solved: Solved, support: Solved, *, condition: bool = True, known: FloatArray | None = None
) -> Json:
    """Return figures over all places of a table, at its own loads and at the support loads.

    Support loads that failed anywhere are not in the table, and are named here. Without `condition` the
    condition number is None: it takes some per cent of the contact, unless it was `known` with the
    solutions.
    """
    solutions = [solution for _, solution in solved]
    iterations = np.concatenate([solution.iterations.ravel() for solution in solutions])
    unsolved = ~np.all([s.status == Status.CONVERGED for _, s in support], axis=(0, 1))
    return {
        "newton_iterations_max": int(iterations.max()),
        "newton_iterations_mean": float(iterations.mean()),
        f"newton_points_over_{FEW_ITERATIONS}": int(np.count_nonzero(iterations > FEW_ITERATIONS)),
        "residuals_max": max(worst_residual(solution) for solution in solutions),
        "condition_number_max": _worst_condition(solved, known) if condition else None,
        "patch_outgrown_points": sum(int(solution.beyond.sum()) for solution in solutions),
        "failed_points": failed_points(solutions),
        "support_loads_left_out": support[0][1].load[unsolved].tolist(),
    }


def failed_points(solutions: Sequence[ContactSolution]) -> dict[str, int]:
    """Return how many points failed, by the name of their status; empty if none did."""
    codes = Counter(int(code) for solution in solutions for code in solution.status.ravel() if code)
    return {Status(code).name: count for code, count in sorted(codes.items())}


def _worst_condition(solved: Solved, known: FloatArray | None = None) -> float | None:
    """Return the largest condition number of the compliance between candidates; None if one is not definite.

    Operating points of one center distance share their compliance, which is assessed once.
    """
    if known is None:
        shared = {id(problem.compliance): problem.compliance for problem, _ in solved}
        known = np.array([condition_numbers(compliance).max() for compliance in shared.values()])
    worst = float(known.max())
    return worst if np.isfinite(worst) else None
