"""The high-pass of sounds where SciPy is not installed; the same as its filter within rounding.

With SciPy its filter is used, which takes a ninth of the time.
"""

from __future__ import annotations

import math

import numpy as np

from dynamics.types import FloatArray


def plain_high_passed(
    values: FloatArray, slope: int, lowest: float, sample_rate: float, beyond: int
) -> FloatArray:
    """Return series (..., T) without trend and without what is slower than `lowest` in Hz, and phase shift.

    A Butterworth filter of even order `slope` runs forwards and backwards; `beyond`: samples reflected
    at both ends.
    """
    rows = np.reshape(values, (-1, np.shape(values)[-1]))
    time = np.arange(rows.shape[1]) - 0.5 * (rows.shape[1] - 1)
    level = rows.mean(axis=1, keepdims=True) + np.outer(rows @ time / (time @ time), time)
    extended = np.pad(rows - level, ((0, 0), (beyond, beyond)), mode="reflect")
    for _ in range(2):  # each turns the series round
        extended = np.array([_forwards(row, slope, lowest / sample_rate) for row in extended])[:, ::-1]
    return np.reshape(extended[:, beyond : beyond + rows.shape[1]], np.shape(values))


def _forwards(series: FloatArray, slope: int, frequency: float) -> FloatArray:
    """Return a series after all sections of the filter, which begin at rest; `frequency`: cycles a sample."""
    angle = 2.0 * math.pi * frequency
    first, samples = float(series[0]), series.tolist()
    for section in range(slope // 2):
        # 1 / (2 Q) of the section's pair of poles
        damping = math.sin(angle) * math.sin((2 * section + 1) * math.pi / (2 * slope))
        gain = 0.5 * (1.0 + math.cos(angle)) / (1.0 + damping)
        back, further = -2.0 * math.cos(angle) / (1.0 + damping), (1.0 - damping) / (1.0 + damping)
        # memory after a constant `first` for ever, of which nothing reaches the next section
        near, far, filtered = -gain * first, gain * first, []
        for sample in samples:
            value = gain * sample + near
            near, far = -2.0 * gain * sample - back * value + far, gain * sample - further * value
            filtered.append(value)
        first, samples = 0.0, filtered
    return np.array(samples)
