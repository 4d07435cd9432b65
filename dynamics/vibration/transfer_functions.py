"""Transfer functions of a reduced housing: from forces on its seats to points and to its surface."""

from __future__ import annotations

import numpy as np

from dynamics.checks import not_negative
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.types import FloatArray
from dynamics.vibration.modal_amplitudes import modal_amplitudes
from dynamics.vibration.motion_quantity import MotionQuantity
from dynamics.vibration.seat_forces import ComplexArray
from dynamics.vibration.surface_weight import mean_square


def transfer_functions(
    housing: ReducedHousing,
    frequency: FloatArray,
    response: FloatArray,
    excitation: FloatArray | None = None,
    quantity: MotionQuantity = MotionQuantity.VELOCITY,
) -> ComplexArray:
    """Return the motion per unit force: receptance, mobility or accelerance by the quantity.

    Rows are motions per reduced coordinate, such as `PointMotion.motion`. They are reciprocal: exchanging
    response and excitation transposes the result. Forces on seats act with the residual flexibility of the
    modes left out; forces elsewhere act through the reduced coordinates alone.

    Parameters
    ----------
    housing : ReducedHousing
        With mass.
    frequency : (n,) array
        Hz.
    response : (q, r) array
    excitation : (e, r) array, optional
        By default the motions of the seats.
    quantity : MotionQuantity

    Returns
    -------
    (n, q, e) complex array
        m/N, m/(N s) or m/(N s^2) for rows of points; rad and N m for those of rotations.

    Raises
    ------
    InputError
        A frequency is negative, or as `modal_amplitudes`.
    """
    hertz = np.asarray(frequency, dtype=float)
    for index, value in enumerate(hertz):
        not_negative(f"frequency[{index}]", float(value))
    loads = np.eye(housing.motions, len(housing.mass)) if excitation is None else np.asarray(excitation)
    amplitude = modal_amplitudes(housing, hertz, loads[None].astype(complex))
    moved = np.swapaxes(amplitude @ (np.asarray(response) @ housing.modes[1]).T, 1, 2)
    return quantity.of(moved, hertz[:, None, None])


def mean_square_mobility(housing: ReducedHousing, frequency: FloatArray, weight: FloatArray) -> FloatArray:
    """Return the mean square velocity per mean square force on each motion of the seats, (n, s).

    Parameters
    ----------
    housing : ReducedHousing
    frequency : (n,) array
        Hz.
    weight : (r, r) array
        Of the surface (`surface_weight`).

    Returns
    -------
    (n, s) array
        m^2/(N s)^2, of moments 1/(N s)^2.
    """
    coordinates = np.eye(len(housing.mass))
    return 2.0 * mean_square(np.swapaxes(transfer_functions(housing, frequency, coordinates), 1, 2), weight)
