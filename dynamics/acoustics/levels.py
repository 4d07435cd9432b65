"""Levels in decibels: sound power, sums, A-weighting.

References
----------
.. [1] IEC 61672-1:2013, Sound level meters - Part 1, annex E: A-weighting in closed form.
.. [2] ISO 3740 series: sound power levels re 1 pW.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from dynamics.errors import InputError
from dynamics.types import FloatArray

REFERENCE_POWER = 1e-12  # W
REFERENCE_PRESSURE = 20e-6  # Pa, rms
FLOOR = -200.0
"""Level of no power at all, dB: -inf would spread through sums and plots."""
POLES = (20.598997, 107.65265, 737.86223, 12194.217)  # Hz, of [1]_: twofold, single, single, twofold


def sound_power_level(power: ArrayLike) -> FloatArray:
    """Return the sound power level re 1e-12 W, dB, at least `FLOOR`.

    Parameters
    ----------
    power : array
        W, any shape.

    Raises
    ------
    InputError
        If a power is negative or no number.
    """
    values = np.asarray(power, dtype=float)
    if not np.all(values >= 0.0):
        raise InputError("power", float(np.min(values)), "at least 0 W everywhere")
    lowest = REFERENCE_POWER * 10.0 ** (FLOOR / 10.0)
    return np.asarray(10.0 * np.log10(np.maximum(values, lowest) / REFERENCE_POWER))


def level_sum(levels: ArrayLike, axis: int = -1) -> FloatArray:
    """Return the level of the sum of powers, dB: two equal levels give 3.01 dB more."""
    return np.asarray(10.0 * np.log10(np.sum(10.0 ** (np.asarray(levels, dtype=float) / 10.0), axis=axis)))


def a_weighting(frequency: ArrayLike) -> FloatArray:
    """Return the A-weighting in dB, 0 at 1 kHz; `FLOOR` at most below at 0 Hz.

    Parameters
    ----------
    frequency : array
        Hz, any shape, at least 0.
    """
    weight = _response(np.asarray(frequency, dtype=float)) / _response(np.array(1000.0))
    return np.asarray(20.0 * np.log10(np.maximum(weight, 10.0 ** (FLOOR / 20.0))))


def _response(frequency: FloatArray) -> FloatArray:
    """Return the gain of the weighting network, not normalized."""
    square = frequency**2
    first, second, third, fourth = (pole**2 for pole in POLES)
    middle = np.sqrt((square + second) * (square + third))
    return np.asarray(fourth * square**2 / ((square + first) * middle * (square + fourth)))


def free_field_pressure(power: ArrayLike, distance: float, impedance: float) -> FloatArray:
    """Return the rms sound pressure at a distance from a source that radiates evenly to all sides, Pa.

    Parameters
    ----------
    power : array
        W.
    distance : float
        m; no floor, no room.
    impedance : float
        rho c of the air, Pa s/m.
    """
    return np.asarray(np.sqrt(np.asarray(power, dtype=float) * impedance / (4.0 * np.pi)) / distance)
