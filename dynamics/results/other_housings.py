"""Housings of a scene that the scene of a run did not have so."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from dynamics.joints import Housing
from dynamics.results.run_result import RunResult
from dynamics.types import Json

SAME = 1e-6
"""Largest difference between matrices of the same housing, of their largest entry."""


def other_housings(housings: Iterable[Housing], run: RunResult) -> tuple[str, ...]:
    """Return the names of housings with mass in which a run did not move."""
    run_housings = {part["name"]: part for part in run.case.get("housings", ())}
    massive = (housing for housing in housings if housing.mass is not None)
    return tuple(housing.name for housing in massive if not _same(housing, run_housings.get(housing.name)))


def _same(housing: Housing, part: Json | None) -> bool:
    """Whether a part of a stored scene has a housing's matrices at the seats: signs of modes are free."""
    if part is None or part["mass"] is None:
        return False
    seats = slice(len(housing.stiffness) - housing.modal_coordinates)
    for name in ("stiffness", "mass", "damping"):
        both = (
            np.zeros((0, 0)) if of[name] is None else np.array(of[name], float)
            for of in (vars(housing), part)
        )
        matrix_here, other = (matrix[seats, seats] for matrix in both)
        if matrix_here.shape != other.shape or np.any(
            np.abs(matrix_here - other) > SAME * np.abs(matrix_here).max(initial=0.0)
        ):
            return False
    return True
