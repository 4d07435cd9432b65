"""Levels of vibration in decibels.

References
----------
.. [1] ISO 1683:2015, Acoustics - Preferred reference values: 1 pm, 1 nm/s, 1 um/s^2, root mean square.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from dynamics.errors import InputError
from dynamics.types import FloatArray
from dynamics.vibration.motion_quantity import MotionQuantity

REFERENCE = {
    MotionQuantity.DISPLACEMENT: 1e-12,
    MotionQuantity.VELOCITY: 1e-9,
    MotionQuantity.ACCELERATION: 1e-6,
}
"""Root mean square values of 0 dB, SI, of [1]_."""
FLOOR = -200.0
"""Level of no motion at all, dB: -inf would spread through sums and plots."""


def vibration_level(rms: ArrayLike, quantity: MotionQuantity = MotionQuantity.VELOCITY) -> FloatArray:
    """Return the level of root mean square values, dB re 1 nm/s for velocities, at least `FLOOR`.

    Parameters
    ----------
    rms : array
        m, m/s or m/s^2, any shape; 1/sqrt(2) of a peak amplitude.
    quantity : MotionQuantity

    Raises
    ------
    InputError
        If a value is negative or no number.
    """
    values = np.asarray(rms, dtype=float)
    if not np.all(values >= 0.0):
        raise InputError("rms", float(np.min(values)), "at least 0 everywhere")
    return np.asarray(20.0 * np.log10(np.maximum(values / REFERENCE[quantity], 10.0 ** (FLOOR / 20.0))))


def overall(rms: ArrayLike, axis: int = -1) -> FloatArray:
    """Return the root mean square of all harmonics together: the root of the sum of their squares."""
    return np.asarray(np.sqrt(np.sum(np.square(np.asarray(rms, dtype=float)), axis=axis)))
