"""Time and memory of a reduction, predicted before it runs."""

from __future__ import annotations

from typing import NamedTuple

from bounds import at_most
from dynamics.errors import InputError
from dynamics.housing_modes.meshed_housing import MeshedHousing

REFERENCE = 1e5
"""Freedoms at which the figures below hold: walls 10 mm thick, one CPU core of 2020 or later."""

ASSEMBLY, FACTOR, SOLVE = 5.0, 10.0, 0.1
"""CPU seconds: matrices and their ordering, factor, one step of Lanczos' method or one deflection."""
SOLVES_PER_MODE = 2.3
FILL = 1.0e9
"""Bytes of the matrices and their factor."""


class ReductionCost(NamedTuple):
    """CPU seconds on one thread, and bytes of the largest working set."""

    seconds: float
    bytes: float


class CostLimit(NamedTuple):
    """What a reduction may cost: CPU seconds and bytes."""

    seconds: float = 600.0
    bytes: float = 8e9


def reduction_cost(freedoms: int, modes: int, motions: int) -> ReductionCost:
    """Predict the cost of `reduce_housing`.

    Fitted to a thin-walled cast box of 20 000 to 200 000 freedoms; a solid block fills its factor more.

    Parameters
    ----------
    freedoms : int
        Of the mesh.
    modes : int
    motions : int
        Of all seats.
    """
    size = freedoms / REFERENCE
    solves = SOLVES_PER_MODE * modes + motions
    seconds = ASSEMBLY * size + FACTOR * size**1.5 + SOLVE * size**1.2 * solves
    vectors = 1.5 * modes + 4.0 * motions + modes  # of Lanczos' method, deflections, coordinates
    return ReductionCost(seconds, FILL * size**1.2 + 8.0 * freedoms * vectors)


def check_cost(housing: MeshedHousing, limit: CostLimit) -> ReductionCost:
    """Return the predicted cost.

    Raises
    ------
    InputError
        It is above the limit.
    """
    motions = sum(seat.motions for seat in housing.seats)
    cost = reduction_cost(housing.mesh.freedoms, housing.modes, motions)
    advice = f"{housing.mesh.freedoms} freedoms, {housing.modes} modes: use a coarser mesh or fewer modes."
    if cost.seconds > limit.seconds:
        raise InputError("predicted_seconds", cost.seconds, at_most(limit.seconds, "s"), advice)
    if cost.bytes > limit.bytes:
        raise InputError("predicted_bytes", cost.bytes, at_most(limit.bytes), advice)
    return cost
