"""Signals to listen to: a quantity at uniform steps of time, from orders or from a run."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from bounds import at_most
from dynamics.acoustics.hull import ComplexArray
from dynamics.checks import increasing, integer
from dynamics.errors import InputError
from dynamics.orders.resampling import resampled
from dynamics.types import FloatArray

SAMPLE_RATE = 48_000
HALF_LENGTH = 64  # of the resampling filter, in samples of the lower rate
LARGEST_STEP = 20_000  # of the lower of two rates in their ratio
PASSED = 0.45
"""Highest frequency over the sample rate: the resampling filter passes it unchanged."""


@dataclass(frozen=True)
class Recording:
    """A signal over time.

    Attributes
    ----------
    samples : (N,) array
        In `unit`.
    sample_rate : int
        Hz.
    quantity, unit : str
        What it is, e.g. ``"sound pressure at 1 m"`` in ``"Pa"``. A bearing force is no sound pressure.

    Raises
    ------
    InputError
        Samples are no finite row of at least two, or the sample rate is no integer above zero.
    """

    samples: FloatArray
    sample_rate: int
    quantity: str
    unit: str

    def __post_init__(self) -> None:
        samples = np.asarray(self.samples, dtype=float)
        if samples.ndim != 1 or samples.size < 2 or not np.all(np.isfinite(samples)):
            raise InputError("samples", samples.shape, "at least two finite samples, (N,)")
        integer("sample_rate", self.sample_rate, 1, 10_000_000)
        object.__setattr__(self, "samples", samples)

    @property
    def peak(self) -> float:
        """Return the largest magnitude, in `unit`."""
        return float(np.abs(self.samples).max())

    def resampled(self, sample_rate: int = SAMPLE_RATE) -> Recording:
        """Return the same signal at another rate, by a polyphase filter without phase shift.

        Up to 0.45 of the lower rate contents keep their level within 0.001 dB; above 0.55 of it they lose at
        least 70 dB.
        """
        integer("sample_rate", sample_rate, 1, 10_000_000)
        samples = at_rate(self.samples, self.sample_rate, sample_rate)
        return Recording(samples, sample_rate, self.quantity, self.unit)


def at_rate(values: FloatArray, sample_rate: float, to_rate: int) -> FloatArray:
    """Return a series (T,) at another rate as `Recording.resampled` does; both rates above 0 Hz.

    Their ratio is taken as one of integers, within 3e-9: the lower rate has at most 20 000 steps.
    """
    lower = min(sample_rate, to_rate)
    ratio = Fraction(max(sample_rate, to_rate) / lower).limit_denominator(LARGEST_STEP)
    more, fewer = ratio.numerator, ratio.denominator
    up, down = (more, fewer) if to_rate >= sample_rate else (fewer, more)
    return resampled(values, up, down, HALF_LENGTH)


def order_recording(
    time: FloatArray,
    frequency: FloatArray,
    amplitude: ComplexArray,
    quantity: str,
    unit: str,
    sample_rate: int = SAMPLE_RATE,
) -> Recording:
    """Return the sum of abs(a) cos(2 pi integral f dt + arg a) over the orders of a run.

    Frequencies, magnitudes and phases are linear between the given times.

    Parameters
    ----------
    time : (B,) array
        s, increasing.
    frequency : (K, B) array
        Hz, at most `PASSED` times the sample rate.
    amplitude : (K, B) array
        Complex or real peak amplitudes, in `unit`.

    Raises
    ------
    InputError
        Shapes differ, times do not increase, or a frequency is too high.
    """
    time, frequency, amplitude = increasing("time", time), np.asarray(frequency), np.asarray(amplitude)
    if frequency.ndim != 2 or frequency.shape != amplitude.shape or frequency.shape[1] != time.size:
        raise InputError("amplitude", amplitude.shape, f"(K, {time.size}) as the frequencies")
    if frequency.max() > PASSED * sample_rate:
        raise InputError("frequency", float(frequency.max()), at_most(PASSED * sample_rate, "Hz"))
    at = np.arange(int((time[-1] - time[0]) * sample_rate) + 1) / sample_rate + time[0]
    samples = np.zeros(at.size)
    for tone, peaks in zip(frequency, amplitude, strict=True):
        phase = _turned(time, tone, at) + np.interp(at, time, np.unwrap(np.angle(peaks)))
        samples += np.interp(at, time, np.abs(peaks)) * np.cos(phase)
    return Recording(samples, sample_rate, quantity, unit)


def _turned(time: FloatArray, frequency: FloatArray, at: FloatArray) -> FloatArray:
    """Return 2 pi times the integral of a piecewise linear frequency, exactly."""
    step = np.diff(time)
    whole = np.concatenate([[0.0], np.cumsum(0.5 * step * (frequency[1:] + frequency[:-1]))])
    piece = np.clip(np.searchsorted(time, at, "right") - 1, 0, time.size - 2)
    since = at - time[piece]
    slope = (np.diff(frequency) / step)[piece]
    return np.asarray(2.0 * np.pi * (whole[piece] + since * (frequency[piece] + 0.5 * slope * since)))
