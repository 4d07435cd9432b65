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
    """Return figures over all operating points of a table, at its own loads and at the support loads.

    Support loads that failed anywhere are not in the table, and are named here. The condition number takes
    some per cent of the contact, unless it is `known`; without `condition` it is None.
    """
    solutions = [solution for _, solution in solved]
    iterations = np.concatenate([solution.iterations.ravel() for solution in solutions])
    converged = np.all([solution.status == Status.CONVERGED for _, solution in support], axis=(0, 1))
    return {
        "newton_iterations_max": int(iterations.max()),
        "newton_iterations_mean": float(iterations.mean()),
        f"newton_points_over_{FEW_ITERATIONS}": int(np.count_nonzero(iterations > FEW_ITERATIONS)),
        "residuals_max": max(worst_residual(solution) for solution in solutions),
        "condition_number_max": _worst_condition(solved, known) if condition else None,
        "patch_outgrown_points": sum(int(solution.beyond.sum()) for solution in solutions),
        "failed_points": failed_points(solutions),
        "support_loads_left_out": support[0][1].load[~converged].tolist(),
    }


def failed_points(solutions: Sequence[ContactSolution]) -> dict[str, int]:
    """Return how many points failed, by the name of their status; empty if none did."""
    status = np.concatenate([solution.status.ravel() for solution in solutions])
    codes = Counter(status[status != Status.CONVERGED].tolist())
    return {Status(code).name: count for code, count in sorted(codes.items())}


def _worst_condition(solved: Solved, known: FloatArray | None) -> float | None:
    """Return the largest condition number of the compliances; None if one is not definite."""
    if known is None:
        # operating points of one center distance share their compliance
        distinct = {id(problem.compliance): problem.compliance for problem, _ in solved}
        known = np.array([condition_numbers(compliance).max() for compliance in distinct.values()])
    worst = float(known.max())
    return worst if np.isfinite(worst) else None
