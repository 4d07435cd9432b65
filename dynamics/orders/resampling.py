"""Series at another rate of samples, by a polyphase filter."""

from __future__ import annotations

import numpy as np
from scipy.signal import fftconvolve, firwin, kaiser_beta, resample_poly

from dynamics.types import FloatArray

KAISER = 12.0  # shape of the filter's window: 118 dB
NYQUIST = 0.5  # cycles a sample
REMOVED, TRANSITION = 80.0, 0.1
"""dB by which a low-pass removes what is above its transition; width of that, of the frequency passed."""


def resampled(values: FloatArray, up: int, down: int, half_length: int) -> FloatArray:
    """Return a series (T,) at `up` / `down` times its rate, without phase shift; it is 0 before and after.

    Contents that lie by 1.9 / `half_length` of the lower rate or more below half of it keep their amplitude
    within 3e-6; those as far above it are removed by 112 dB.

    Parameters
    ----------
    half_length : int
        Of the filter, in samples of the lower rate.
    """
    if up == down:
        return np.array(values, dtype=float)
    steps = max(up, down)
    taps = firwin(2 * half_length * steps + 1, 1.0 / steps, window=("kaiser", KAISER))
    made = resample_poly(values, up, down, window=taps)  # type: ignore[call-overload]  # its stubs know none
    return np.asarray(made)


def interpolated(values: FloatArray, factor: int, half_length: int) -> FloatArray:
    """Return a series (T,) with `factor` - 1 values between its samples, (`factor` (T - 1) + 1,).

    It is continued beyond its ends by its odd reflection, so that a mean and a slope leave no ripple there.
    """
    beyond = min(half_length, values.size - 1)
    head = 2.0 * values[0] - values[beyond:0:-1]
    tail = 2.0 * values[-1] - values[-2 : -beyond - 2 : -1]
    made = resampled(np.concatenate([head, values, tail]), factor, 1, half_length)
    return made[factor * beyond : factor * (beyond + values.size - 1) + 1]


def low_passed(values: FloatArray, frequency: float) -> FloatArray:
    """Return a series (T,) without what is above a frequency, without phase shift; it is 0 before and after.

    Contents up to the frequency keep their amplitude within 0.01 %; those 10 % above it are removed by 80 dB.

    Parameters
    ----------
    frequency : float
        Cycles a sample; a series that holds no more is returned as it is.
    """
    middle = frequency * (1.0 + 0.5 * TRANSITION)
    if frequency * (1.0 + TRANSITION) >= NYQUIST:
        return np.array(values, dtype=float)
    half = int(np.ceil((REMOVED - 7.95) / (2.285 * 2.0 * np.pi * TRANSITION * frequency) / 2.0))
    taps = firwin(2 * half + 1, middle, window=("kaiser", kaiser_beta(REMOVED)), fs=1.0)
    return np.asarray(fftconvolve(values, taps)[half : half + np.size(values)])
