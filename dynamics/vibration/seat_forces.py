"""Forces of bearings on the seats of a reduced housing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dynamics.errors import InputError
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.linearize import HarmonicResponse
from dynamics.types import FloatArray

ComplexArray = NDArray[np.complex128]


def seat_forces(
    response: HarmonicResponse, housing: ReducedHousing, bearings: Sequence[str] | None = None
) -> ComplexArray:
    """Return the forces on the seats of a housing in a harmonic response.

    Parameters
    ----------
    response : HarmonicResponse
        S speeds, H harmonics; in the frame of the housing's mesh.
    housing : ReducedHousing
    bearings : sequence of str, optional
        Bearings in the order of the seats; by default those with the names of the seats.

    Returns
    -------
    (S, H, s) array
        Complex peak amplitudes by the seats' motions, along their own axes, N and N m.

    Raises
    ------
    InputError
        A bearing is not in the response, or their number is not that of the seats.
    """
    names = tuple(seat.name for seat in housing.seats) if bearings is None else tuple(bearings)
    if len(names) != len(housing.seats):
        raise InputError("bearings", len(names), f"{len(housing.seats)}, one per seat")
    for index, name in enumerate(names):
        if name not in response.bearing:
            raise InputError(f"bearings[{index}]", name, f"one of {', '.join(response.bearing)}")
    signals = response.bearing_force
    rows = [_turn(seat.axes, signals.shape[1])[: len(seat.motions)] for seat in housing.seats]
    own = [signals[response.bearing.index(name)] for name in names]
    forces = [np.einsum("mc,csh->shm", turn, force) for turn, force in zip(rows, own, strict=True)]
    return np.concatenate(forces, axis=2)


def _turn(axes: FloatArray, signals: int) -> FloatArray:
    """Return forces and moments along the seat's axes per the bearing's signals, (6, 3 or 6)."""
    return np.asarray(np.kron(np.eye(2), axes.T)[:, :signals])
