"""Flank results: what happens on the flanks of a gear pair at one load and one alignment."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from fe_contact.analysis.load_distribution import LoadDistribution, load_distribution
from fe_contact.analysis.pair_contact import pair_contact
from fe_contact.analysis.request import check_request
from fe_contact.analysis.table_places import table_places
from fe_contact.checks import finite
from fe_contact.errors import InputError, SolveError
from fe_contact.geometry import GearPair
from fe_contact.planning import make_plan
from fe_contact.types import FloatArray

POSITIONS = 64


def flank_results(
    pair: GearPair,
    *,
    torque: float | None = None,
    normal_force: float | None = None,
    misalignment: float = 0.0,
    center_distance_change: float = 0.0,
    at: ArrayLike | None = None,
    tolerance: float | None = None,
    level: str | None = None,
    model: str = "auto",
    effects: Mapping[str, str] | None = None,
    cache: Path | None = None,
) -> LoadDistribution:
    """Solve the contact of one load and alignment, and keep what happens on the flanks.

    Parameters
    ----------
    pair : GearPair
    torque, normal_force : float
        Torque on the driving gear in N m, or normal force in N; exactly one.
    misalignment, center_distance_change : float
        See `analyze`, m.
    at : array_like, optional
        Positions in base pitches; default: 64 over one mesh cycle, as `contact_pattern` needs them.
    tolerance, level, model, effects, cache
        See `analyze`.

    Returns
    -------
    LoadDistribution

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    MeshError, SolveError
        No acceptable mesh, or positions without a solution.
    """
    checked = check_request(
        pair,
        torques=None if torque is None else [torque],
        normal_forces=None if normal_force is None else [normal_force],
        tolerance=tolerance,
        level=level,
        model=model,
        misalignments=[misalignment],
        center_distance_changes=[center_distance_change],
        effects=effects,
    )
    request = checked.request
    position = _positions(at)
    plan = make_plan(pair, request.load, request.accuracy, checked.model)
    (place,) = table_places(request.scene, request.choices, pair_contact(pair, plan, cache)).places
    problem, solution = place.solve(position, plan.load)
    if not solution.converged:
        failed = int(np.count_nonzero(solution.status))
        raise SolveError(f"{failed} of {position.size} positions have no solution", partial=solution)
    return load_distribution(place.contact.pair, problem, solution)


def _positions(at: ArrayLike | None) -> FloatArray:
    """Positions asked for, or a whole mesh cycle."""
    if at is None:
        return np.arange(POSITIONS) / POSITIONS
    position = np.atleast_1d(np.asarray(at, dtype=float))
    if position.ndim != 1 or position.size == 0:
        raise InputError("at", at, "a list of positions in base pitches")
    for i, value in enumerate(position):
        finite(f"at[{i}]", float(value), "In base pitches: 0 to 1 is one mesh cycle.")
    return position
