"""Arrays of the STE database from contact solutions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fe_contact.contact import Candidates, ContactProblem, ContactSolution, contact_pressure
from fe_contact.geometry import ParallelAxes
from fe_contact.types import BoolArray, FloatArray, IntArray, Status

OF_PAIRS = ("load_share", "pair_pressure")
"""Names of the arrays that have an axis of tooth pairs."""

OF_SUPPORT = ("static_transmission_error", "tangent_compliance", "pairs_in_contact")
"""Names of the arrays that a table stores at support loads."""


def contact_fields(
    pair: ParallelAxes,
    problem: ContactProblem,
    solution: ContactSolution,
    pressed: tuple[FloatArray, BoolArray] | None = None,
) -> dict[str, NDArray[Any]]:
    """Return the arrays (P, F, ...) of one operating point by their names in the database.

    The last axis of `OF_PAIRS` are the N pairs of its m candidates. `pressed` is the `contact_pressure` of
    its forces, if it is known.
    """
    candidates = problem.candidates
    good = solution.status == Status.CONVERGED
    loaded = solution.force * candidates.torque_share[:, None, :]
    total = np.where(good, loaded.sum(axis=2), 1.0)
    pressure, edge = pressed or contact_pressure(problem, solution.force)
    of_pair = candidates.pair[:, None] == np.unique(candidates.pair)
    largest = largest_by_pair(candidates, np.where(edge, 0.0, pressure))
    centroid = (loaded @ candidates.face_position) / total
    along_path = pair.tilt_arm(candidates.touch.roll_1, 0.0)
    return {
        "static_transmission_error": solution.deflection,
        "tangent_compliance": solution.tangent,
        "load_share": (loaded @ of_pair) / total[..., None],
        "face_centroid": centroid,
        "load_arm": centroid + np.einsum("pfm,pm->pf", loaded, along_path) / total,
        "max_pressure": np.where(good, largest.max(axis=2), np.nan),
        "pair_pressure": np.where(good[..., None], largest, np.nan),
        "edge_pressure": np.where(good, np.where(edge, pressure, 0.0).max(axis=2), np.nan),
        "pairs_in_contact": carrying_pairs(solution.force, candidates),
        "status": solution.status,
        "residuals": solution.residuals,
    }


def largest_by_pair(candidates: Candidates, values: FloatArray) -> FloatArray:
    """Return the largest of values (P, F, m) of the candidates of each pair, (P, F, N)."""
    pairs = np.unique(candidates.pair).size
    return np.asarray(values.reshape(*values.shape[:2], pairs, -1).max(axis=3))


def support_fields(problem: ContactProblem, solution: ContactSolution) -> dict[str, NDArray[Any]]:
    """Return the arrays (P, S) of one operating point at the support loads, by name."""
    carrying = carrying_pairs(solution.force, problem.candidates)
    return dict(zip(OF_SUPPORT, (solution.deflection, solution.tangent, carrying), strict=True))


def carrying_pairs(force: FloatArray, candidates: Candidates) -> IntArray:
    """Count the pairs (P, F) of which any candidate carries load, by their forces (P, F, m) in N."""
    of_pair = candidates.pair[:, None] == np.unique(candidates.pair)
    loaded_candidates = (force > 0.0).astype(float) @ of_pair
    return np.asarray((loaded_candidates > 0.0).sum(axis=2))
