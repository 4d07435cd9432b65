"""From contact solutions to the arrays of the STE database."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fe_contact.analysis.pairs.pair_contact import OperatingPoints
from fe_contact.contact import ContactProblem, ContactSolution, at_edges, contact_pressure
from fe_contact.geometry import ParallelAxes
from fe_contact.ste import PairFacts
from fe_contact.types import BoolArray, FloatArray, IntArray, Status


def pair_facts(pair: ParallelAxes) -> PairFacts:
    """Closed-form facts of the pair that users of the table need."""
    return PairFacts(
        teeth=(pair.pinion.teeth, pair.wheel.teeth),
        base_radius=(pair.pinion.base_radius, pair.wheel.base_radius),
        base_pitch=pair.base_pitch,
        base_helix_angle=abs(pair.base_helix_angle),
        center_distance=pair.center_distance,
        working_pressure_angle=pair.working_pressure_angle,
        face_width=pair.face_width,
        helix_hand=int(np.sign(pair.base_helix_angle)),
        internal=pair.internal,
    )


def table_fields(
    points: OperatingPoints, solved: list[tuple[ContactProblem, ContactSolution]]
) -> dict[str, NDArray[Any]]:
    """Arrays of the database at the requested loads, (P, F, M, D, ...), and its pair axis."""
    seen = np.concatenate([problem.candidates.pair for problem, _ in solved])
    pairs = np.arange(seen.min(), seen.max() + 1)
    fields = [_contact_fields(problem, solution, pairs) for problem, solution in solved]
    no_load = points.gathered([solution.no_load[:, None] for _, solution in solved])[:, 0]
    gathered = {name: points.gathered([field[name] for field in fields]) for name in fields[0]}
    return gathered | {"pair": pairs, "no_load_transmission_error": no_load}


def table_support(
    points: OperatingPoints, solved: list[tuple[ContactProblem, ContactSolution]]
) -> dict[str, NDArray[Any]]:
    """Support loads that converged everywhere, and their arrays (P, S, M, D)."""
    fields = [_support_fields(problem, solution) for problem, solution in solved]
    good = np.all([solution.status == Status.CONVERGED for _, solution in solved], axis=(0, 1))
    gathered = {name: points.gathered([field[name][:, good] for field in fields]) for name in fields[0]}
    return gathered | {"support_force": solved[0][1].load[good]}


def _contact_fields(
    problem: ContactProblem, solution: ContactSolution, pairs: IntArray
) -> dict[str, NDArray[Any]]:
    """Arrays (P, F, ...) of one operating point of the table, by name in the database.

    Pressure is that of `contact_pressure`.

    Parameters
    ----------
    pairs : ndarray of int, shape (N,)
        Pair indices of the table.
    """
    candidates = problem.candidates
    good = solution.status == Status.CONVERGED
    loaded = solution.force * candidates.torque_share[:, None, :]
    total = np.where(good, loaded.sum(axis=2), 1.0)
    pressure = contact_pressure(problem, solution.force)
    edge = at_edges(problem, solution.force, pressure)
    of_pair = candidates.pair[:, None] == pairs
    return {
        "static_transmission_error": solution.deflection,
        "tangent_compliance": solution.tangent,
        "load_share": (loaded @ of_pair) / total[..., None],
        "face_centroid": (loaded @ candidates.face_position) / total,
        "max_pressure": np.where(good, np.where(edge, 0.0, pressure).max(axis=2), np.nan),
        "edge_pressure": np.where(good, np.where(edge, pressure, 0.0).max(axis=2), np.nan),
        "pairs_in_contact": _pairs_in_contact(solution.force, of_pair),
        "status": solution.status,
        "residuals": solution.residuals,
    }


def _support_fields(problem: ContactProblem, solution: ContactSolution) -> dict[str, NDArray[Any]]:
    """Arrays (P, S) of one place at the support loads."""
    pair = problem.candidates.pair
    of_pair = pair[:, None] == np.unique(pair)
    return {
        "support_transmission_error": solution.deflection,
        "support_tangent_compliance": solution.tangent,
        "support_pairs_in_contact": _pairs_in_contact(solution.force, of_pair),
    }


def _pairs_in_contact(force: FloatArray, of_pair: BoolArray) -> IntArray:
    """Count the pairs (P, F) of which any candidate carries load."""
    return np.asarray((((force > 0.0).astype(float) @ of_pair) > 0.0).sum(axis=2))
