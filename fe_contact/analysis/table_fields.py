"""Arrays of the STE database from stored arrays of the contact."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fe_contact.analysis.pairs.contact_fields import OF_PAIRS, OF_SUPPORT, contact_fields
from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.analysis.pairs.solved_contact import SolvedContact
from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.geometry import ParallelAxes
from fe_contact.ste import Metadata, PairGeometry, SteDatabase
from fe_contact.types import FloatArray, Status


def table_of_solution(
    pair: ParallelAxes,
    problem: ContactProblem,
    solution: ContactSolution,
    position: FloatArray,
    misalignment: float,
) -> SteDatabase:
    """Return a solution of one alignment, at the center distance of `pair`, as a table without errors.

    Parameters
    ----------
    position : ndarray, shape (P,)
        Positions of one base pitch; the solution may have them in several.
    misalignment : float
        Misalignment of the solution, m.
    """
    period = len(solution.deflection) // position.size
    fields = contact_fields(pair, problem, solution)
    if period == 1:
        del fields["pair_pressure"]  # only tables of several base pitches store it
    return SteDatabase(
        position=(np.arange(period)[:, None] + position).ravel(),
        force=solution.load,
        torque=pair.torque(solution.load),
        misalignment=np.array([misalignment]),
        center_distance_change=np.zeros(1),
        geometry=PairGeometry.of(pair),
        period=period,
        error_estimate=np.full((*solution.deflection.shape, 1, 1), np.nan),
        metadata=Metadata(),
        pair=np.unique(problem.candidates.pair),
        no_load_transmission_error=solution.no_load[:, None, None],
        **{name: values[:, :, None, None] for name, values in fields.items()},
    )


def table_fields(points: OperatingPoints, contacts: Sequence[SolvedContact]) -> dict[str, NDArray[Any]]:
    """Return the arrays of the database at the requested loads, (P, F, M, D, ...), and its pair axis."""
    pair_of_candidates = np.concatenate([contact.problem.candidates.pair for contact in contacts])
    pairs = np.arange(pair_of_candidates.min(), pair_of_candidates.max() + 1)
    stored = [dict(contact.stored) for contact in contacts]
    for arrays, contact in zip(stored, contacts, strict=True):
        numbers = np.unique(contact.problem.candidates.pair)
        if points.period == 1:
            del arrays["pair_pressure"]
        for name in arrays.keys() & OF_PAIRS:  # pairs without candidates at this point carry nothing
            values = np.zeros((*arrays[name].shape[:2], pairs.size))
            values[..., numbers - pairs[0]] = arrays[name]
            arrays[name] = values
    no_load = points.gathered([contact.solution.no_load[:, None] for contact in contacts])[:, 0]
    gathered = {name: points.gathered([arrays[name] for arrays in stored]) for name in stored[0]}
    return gathered | {"pair": pairs, "no_load_transmission_error": no_load}


def table_support(points: OperatingPoints, contacts: Sequence[SolvedContact]) -> dict[str, NDArray[Any]]:
    """Return the support loads that converged everywhere, and their arrays (P, S, M, D)."""
    good = np.all([contact.solution.status == Status.CONVERGED for contact in contacts], axis=(0, 1))
    arrays = {
        name: points.gathered([contact.stored[name][:, good] for contact in contacts]) for name in OF_SUPPORT
    }
    support = {f"support_{name.removeprefix('static_')}": values for name, values in arrays.items()}
    return support | {"support_force": contacts[0].solution.load[good]}
