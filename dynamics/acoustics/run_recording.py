"""Series of a run as recordings: what vibrates, made audible. A force or a motion is no sound pressure."""

from __future__ import annotations

import numpy as np
from scipy.signal import butter, detrend, sosfiltfilt

from bounds import above
from dynamics.acoustics.recording import SAMPLE_RATE, Recording, at_rate
from dynamics.checks import one_of
from dynamics.errors import InputError
from dynamics.results import RunResult
from dynamics.types import FloatArray

LOWEST = 20.0
"""Hz: below it nothing is heard, and slow changes of load would take the full scale."""
SLOPE = 4  # order of the high-pass filter, which is run forwards and backwards
FADE = 0.01  # s at both ends


def audible(values: FloatArray, sample_rate: float) -> FloatArray:
    """Return a series (..., T) without its trend and what is slower than `LOWEST`, without phase shift.

    The level falls by 3 dB at 20 Hz and by less than 0.1 dB above 36 Hz.

    Parameters
    ----------
    sample_rate : float
        Hz, above 40.

    Raises
    ------
    InputError
        The sample rate is too low, or there are fewer than 4 samples.
    """
    if not sample_rate > 2.0 * LOWEST:
        raise InputError("sample_rate", sample_rate, above(2.0 * LOWEST, "Hz"), "It holds nothing audible.")
    samples = np.shape(values)[-1]
    if samples < 4:
        raise InputError("values", samples, "at least 4 samples")
    sections = butter(SLOPE, LOWEST, "highpass", fs=sample_rate, output="sos")
    beyond = min(round(sample_rate / LOWEST), samples - 1)  # a period of the lowest frequency, reflected
    return np.asarray(sosfiltfilt(sections, detrend(values), padtype="even", padlen=beyond))


def principal_direction(values: FloatArray, sample_rate: float) -> tuple[FloatArray, float]:
    """Return the direction (3,) in which a vector (3, T) varies most audibly, and its share of the variance.

    The unit eigenvector of the largest eigenvalue of the covariance; its largest component is positive. Of a
    single mesh it is close to the line of action, since the force of the teeth acts along it.

    Raises
    ------
    InputError
        As `audible`; or nothing varies.
    """
    heard = audible(values, sample_rate)
    variance, axes = np.linalg.eigh(heard @ heard.T)
    if not variance[-1] > 0.0:
        raise InputError("values", 0.0, "a vector that varies", "It is silent.")
    axis = axes[:, -1] * np.sign(axes[np.argmax(np.abs(axes[:, -1])), -1])
    return axis, float(variance[-1] / variance.sum())


def series_recording(
    values: FloatArray, sample_rate: float, quantity: str, unit: str, to_rate: int = SAMPLE_RATE
) -> Recording:
    """Return a series (T,) of a run as a recording of the same duration, at its own level.

    What `audible` leaves, resampled, with cosine fades of 10 ms at both ends. Nothing is equalized or
    compressed. It holds no more than the run: nothing above the pass frequency of its output.

    Raises
    ------
    InputError
        As `audible` and `Recording`.
    """
    lasting = (np.size(values) - 1) / sample_rate
    samples = at_rate(audible(values, sample_rate), sample_rate, to_rate)[: int(lasting * to_rate) + 1]
    fade = min(round(FADE * to_rate), samples.size // 2)
    rise = 0.5 - 0.5 * np.cos(np.pi * np.arange(fade) / fade)
    samples[:fade] *= rise
    samples[samples.size - fade :] *= rise[::-1]
    return Recording(samples, to_rate, quantity, unit)


def force_recording(
    run: RunResult, bearing: str, direction: FloatArray | None = None, to_rate: int = SAMPLE_RATE
) -> Recording:
    """Return the force on a bearing over a run along a direction, in N: no sound pressure.

    Parameters
    ----------
    direction : (3,) array, optional
        In the frame of `RunResult.bearing_force`, of any length above zero; by default the
        `principal_direction`.

    Raises
    ------
    InputError
        The run holds no force on that bearing, the direction is zero, or as `series_recording`.
    """
    if not run.bearing_force.shape[0]:
        advice = "Run with outputs.bearing_forces = true."
        raise InputError("bearing", bearing, "one of a run that holds forces on bearings", advice)
    one_of("bearing", bearing, run.bearing)
    force = run.bearing_force[run.bearing.index(bearing)]
    axis = principal_direction(force, run.sample_rate)[0] if direction is None else unit_vector(direction)
    x, y, z = axis
    quantity = f"force on bearing {bearing} along ({x:.3f}, {y:.3f}, {z:.3f}); no sound pressure"
    return series_recording(axis @ force, run.sample_rate, quantity, "N", to_rate)


def unit_vector(direction: FloatArray) -> FloatArray:
    """Return a direction (3,) of length 1; refuse one that has none."""
    axis = np.asarray(direction, dtype=float)
    if axis.shape != (3,) or not np.all(np.isfinite(axis)) or not np.any(axis):
        raise InputError("direction", axis.tolist(), "three finite components, not all zero")
    return np.asarray(axis / np.linalg.norm(axis))
