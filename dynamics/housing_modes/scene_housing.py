"""A reduced housing as a part of a scene."""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import block_diag

from bounds import Quantity, Text
from dynamics.bearings.matrix import Matrix
from dynamics.errors import InputError
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.housing_modes.seats import SeatFrame
from dynamics.joints import Housing
from dynamics.types import FloatArray

PARALLEL = 1e-3
"""Sine of the angle to z from which a bore is no seat of a shaft along z."""


def scene_housing(housing: ReducedHousing, name: str, bushings: tuple[str, ...] | None = None) -> Housing:
    """Return a reduced housing for a scene; its mesh stands in the scene's frame, shafts along z.

    Parameters
    ----------
    housing : ReducedHousing
        Without mass it is one without modes.
    name : str
        Of the housing in the scene.
    bushings : tuple of str, optional
        Names of the bearings, in the order of the seats; by default those of the seats.

    Raises
    ------
    InputError
        A bore is not along z, the seats have different numbers of motions, or what `Housing` refuses.
    """
    counts = {len(seat.motions) for seat in housing.seats}
    if len(counts) > 1:
        bound = "of as many motions each: 3, 5 or 6"
        raise InputError("seats", sorted(counts), bound, "Reduce the housing with the same motions for all.")
    coordinates = len(housing.stiffness) - housing.motions
    turn = block_diag(*(_turn(seat) for seat in housing.seats), np.eye(coordinates))
    massive = bool(np.any(housing.mass))
    return Housing(
        name,
        tuple(seat.name for seat in housing.seats) if bushings is None else bushings,
        _turned(housing.stiffness, turn),
        _turned(housing.damping, turn) if massive or np.any(housing.damping) else None,
        _turned(housing.mass, turn) if massive else None,
        modal_coordinates=coordinates,
        seat_positions=tuple(_point(seat) for seat in housing.seats),
    )


def _point(seat: SeatFrame) -> tuple[float, float, float]:
    """Return the position of a seat, m."""
    x, y, z = (float(value) for value in seat.position)
    return x, y, z


def _turn(seat: SeatFrame) -> FloatArray:
    """Return the motions along the seat's axes per those along the scene's, (p, p)."""
    off = math.hypot(float(seat.axes[0, 2]), float(seat.axes[1, 2]))
    if off > PARALLEL:
        angle = Quantity(math.asin(min(off, 1.0)), "rad", digits=3)
        bound = Text.of("along z, as the shafts of a scene; its bore is off by ", angle)
        raise InputError(f"seats.{seat.name}", "not along z", bound, "Turn the mesh.")
    whole = np.kron(np.eye(2), seat.axes.T)
    return np.asarray(whole[: len(seat.motions), : len(seat.motions)])


def _turned(matrix: FloatArray, turn: FloatArray) -> Matrix:
    """Return the rows of a matrix over motions along the scene's axes; unchanged where they are the same."""
    own = matrix if np.array_equal(turn, np.eye(len(turn))) else turn.T @ matrix @ turn
    return tuple(tuple(float(value) for value in row) for row in own)
