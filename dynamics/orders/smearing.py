"""What the window of an order analysis rounds off resonances that a run sweeps through."""

from __future__ import annotations

import numpy as np

from dynamics.types import FloatArray, Json

SECOND_MOMENT = 1.0 / 12.0 - 0.5 / np.pi**2
"""Of Hann weights about their middle, over the square of the window's length."""


def smearing(modes: Json, frequency: FloatArray, sweep: FloatArray) -> FloatArray:
    """Return the leading error of amplitudes under Hann windows, of the amplitude near each mode, (S, H).

    An amplitude that passes a mode of frequency f_n and damping ratio z goes with 1/(1 + i x), where
    x = (f - f_n)/(z f_n). Weights of the second moment m over a window in which f changes by d average it to
    (1 - m (d/(z f_n))^2/(1 + i x)^2) of itself; stated is the largest of all modes. Where it is above 0.1
    the amplitude is not resolved: take shorter windows, or run up more slowly.

    Parameters
    ----------
    modes : dict
        `frequency` in Hz and `damping_ratio`, as `RunResult.modes` has them.
    frequency : (S, H) array
        Hz.
    sweep : (S,) array
        Change of the frequency within the window, of its mean.
    """
    natural = np.asarray(modes.get("frequency", ()), dtype=float)
    ratio = np.asarray(modes.get("damping_ratio", ()), dtype=float)
    swept = sweep[:, None] * frequency
    largest = np.full(frequency.shape, 0.0 if natural.size else np.nan)
    for width, center in zip(natural * ratio, natural, strict=True):
        if width > 0.0:
            off = (frequency - center) / width
            largest = np.maximum(largest, SECOND_MOMENT * (swept / width) ** 2 / (1.0 + off**2))
    return largest
