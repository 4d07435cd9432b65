"""Signals to listen to: from orders or from a run, at uniform steps of time, and as WAV files."""

from __future__ import annotations

import json
import math
import struct
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np

from bounds import above, at_least, at_most
from bounds.brief import brief
from dynamics.checks import increasing, integer, one_of, positive
from dynamics.errors import InputError
from dynamics.orders.high_pass import high_passed
from dynamics.orders.resampling import resampled
from dynamics.results import RunResult
from dynamics.types import ComplexArray, FloatArray

SAMPLE_RATE = 48_000  # usual sample rate, Hz; the only one for which loudness is computed
HALF_LENGTH = 64  # half length of the resampling filter, in samples of the lower rate
LARGEST_STEP = 20_000  # largest denominator of the ratio of two rates
PASSED = 0.45
"""Highest frequency over the sample rate: the resampling filter passes it unchanged."""

LOWEST = 20.0
"""Edge of the high-pass, Hz: below it nothing is audible, and slow changes of load would take the full scale.
"""
SLOPE = 4  # order of the high-pass filter, which is run forwards and backwards
FADE = 0.01  # s at both ends
COMMENT = ("quantity", "unit", "full_scale")  # fields of the comment in a WAV file
MAX_SAMPLE_RATE = 10_000_000  # Hz


@brief
@dataclass(frozen=True)
class Recording:
    """A signal over time.

    Raises `InputError`: samples are no finite row of at least two, or the sample rate is no integer above
    zero.
    """

    samples: FloatArray
    """Samples of the signal, in `unit`. Shape (N,)."""
    sample_rate: int
    """Sample rate, Hz."""
    quantity: str
    unit: str
    """`quantity`, `unit`: Quantity of the signal and its unit, e.g. ``"sound pressure at 1 m"`` in ``"Pa"``.
    A bearing force is no sound pressure.
    """

    def __post_init__(self) -> None:
        samples = np.asarray(self.samples, dtype=float)
        if samples.ndim != 1 or samples.size < 2 or not np.all(np.isfinite(samples)):
            raise InputError("samples", samples.shape, "at least two finite samples, (N,)")
        integer("sample_rate", self.sample_rate, 1, MAX_SAMPLE_RATE)
        object.__setattr__(self, "samples", samples)

    @property
    def peak(self) -> float:
        """Return the largest magnitude, in `unit`."""
        return float(np.abs(self.samples).max())

    @property
    def rms(self) -> float:
        """Return the root mean square, in `unit`."""
        return math.sqrt(float((self.samples**2).mean()))

    def resampled(self, sample_rate: int = SAMPLE_RATE) -> Recording:
        """Return the same signal at another rate, by a polyphase filter without phase shift.

        Up to 0.45 of the lower rate contents keep their level within 0.001 dB; above 0.55 of it they lose at
        least 70 dB.
        """
        integer("sample_rate", sample_rate, 1, MAX_SAMPLE_RATE)
        samples = _at_rate(self.samples, self.sample_rate, sample_rate)
        return Recording(samples=samples, sample_rate=sample_rate, quantity=self.quantity, unit=self.unit)


def _at_rate(values: FloatArray, sample_rate: float, to_rate: int) -> FloatArray:
    """Return a series (T,) at another rate as `Recording.resampled` does; both rates above 0 Hz.

    Their ratio is replaced by a fraction whose denominator is at most `LARGEST_STEP`, within 3e-9.
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

    Frequencies, magnitudes and phases are linear between the given times. Raises `InputError`: shapes differ,
    times do not increase, or a frequency is too high.

    Parameters
    ----------
    time : (B,) array
        s, increasing.
    frequency : (K, B) array
        Frequencies, Hz, at most `PASSED` times the sample rate.
    amplitude : (K, B) array
        Complex or real peak amplitudes, in `unit`.
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
    return Recording(samples=samples, sample_rate=sample_rate, quantity=quantity, unit=unit)


def _turned(time: FloatArray, frequency: FloatArray, at: FloatArray) -> FloatArray:
    """Return 2 pi times the integral of a piecewise linear frequency, exactly."""
    step = np.diff(time)
    revolutions = np.concatenate([[0.0], np.cumsum(0.5 * step * (frequency[1:] + frequency[:-1]))])
    piece = np.clip(np.searchsorted(time, at, "right") - 1, 0, time.size - 2)
    since = at - time[piece]
    slope = (np.diff(frequency) / step)[piece]
    return np.asarray(2.0 * np.pi * (revolutions[piece] + since * (frequency[piece] + 0.5 * slope * since)))


def audible(values: FloatArray, sample_rate: float) -> FloatArray:
    """Return a series (..., T) without its trend and what is slower than `LOWEST`, without phase shift.

    The level falls by 3 dB at 20 Hz and by less than 0.1 dB above 36 Hz. `sample_rate`: Hz, above 40. Raises
    `InputError`: the sample rate is too low, or there are fewer than 4 samples.
    """
    if not sample_rate > 2.0 * LOWEST:
        raise InputError("sample_rate", sample_rate, above(2.0 * LOWEST, "Hz"), "It holds nothing audible.")
    samples = np.shape(values)[-1]
    if samples < 4:
        raise InputError("values", samples, "at least 4 samples")
    beyond = min(round(sample_rate / LOWEST), samples - 1)  # a period of the lowest frequency, reflected
    return high_passed(np.asarray(values, dtype=float), SLOPE, LOWEST, sample_rate, beyond)


def principal_direction(values: FloatArray, sample_rate: float) -> tuple[FloatArray, float]:
    """Return the direction (3,) in which a vector (3, T) varies most audibly, and its share of the variance.

    The unit eigenvector of the largest eigenvalue of the covariance; its largest component is positive. With
    a single mesh it is close to the line of action, along which the force of the teeth acts.

    Raises `InputError` as `audible`; or nothing varies.
    """
    weighted = audible(values, sample_rate)
    variance, axes = np.linalg.eigh(weighted @ weighted.T)
    if not variance[-1] > 0.0:
        raise InputError("values", 0.0, "a vector that varies", "It is silent.")
    axis = axes[:, -1] * np.sign(axes[np.argmax(np.abs(axes[:, -1])), -1])
    return axis, float(variance[-1] / variance.sum())


def series_recording(
    values: FloatArray, sample_rate: float, quantity: str, unit: str, to_rate: int = SAMPLE_RATE
) -> Recording:
    """Return a series (T,) of a run as a recording of the same duration, at its own level.

    The recording is the series after `audible`, resampled, with cosine fades of 10 ms at both ends. Nothing
    is equalized or compressed. It holds no more than the run: nothing above the pass frequency of its output.

    Raises `InputError` as `audible` and `Recording`.
    """
    lasting = (np.size(values) - 1) / sample_rate
    samples = _at_rate(audible(values, sample_rate), sample_rate, to_rate)[: int(lasting * to_rate) + 1]
    fade = min(round(FADE * to_rate), samples.size // 2)
    rise = 0.5 - 0.5 * np.cos(np.pi * np.arange(fade) / fade)
    samples[:fade] *= rise
    samples[samples.size - fade :] *= rise[::-1]
    return Recording(samples=samples, sample_rate=to_rate, quantity=quantity, unit=unit)


def force_recording(
    run: RunResult, bearing: str, direction: FloatArray | None = None, to_rate: int = SAMPLE_RATE
) -> Recording:
    """Return the force on a bearing over a run along a direction, in N: no sound pressure.

    `direction` (3,): in the frame of `RunResult.bearing_force`, of any length above zero; by default the
    `principal_direction`. Raises `InputError`: the run holds no force on that bearing, the direction is zero,
    or as `series_recording`.
    """
    if not run.bearing_force.shape[0]:
        remedy = "Run with outputs.bearing_forces = true."
        raise InputError("bearing", bearing, "one of a run that holds forces on bearings", remedy)
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


def common_full_scale(*recordings: Recording) -> float:
    """Return the largest magnitude of several recordings, for files that are compared by ear.

    Raises `InputError`: their units differ, or all are silent.
    """
    units = {recording.unit for recording in recordings}
    if len(units) != 1:
        raise InputError("unit", ", ".join(sorted(units)), "the same of all recordings")
    return positive("peak", max(recording.peak for recording in recordings), "All recordings are silent.")


def write_wav(path: Path | str, recording: Recording, full_scale: float) -> None:
    """Write a recording to a file; parameters and errors are those of `wav_file`."""
    Path(path).write_bytes(wav_file(recording, full_scale))


def wav_file(recording: Recording, full_scale: float) -> bytes:
    """Return the content of a WAV file whose sample 1.0 is `full_scale` in the recording's unit.

    Quantity, unit and full scale stand in the file as JSON (RIFF comment ICMT). Files of the same full scale
    play at their true relative level. `full_scale`: at least the recording's peak; `common_full_scale` of
    those to compare. Raises `InputError`: the recording would be clipped.
    """
    positive("full_scale", full_scale)
    if full_scale < recording.peak:
        bound = at_least(recording.peak, note=f" {recording.unit}, the recording's peak")
        raise InputError("full_scale", full_scale, bound)
    samples, rate = (recording.samples / full_scale).astype("<f4"), recording.sample_rate
    # one channel of numbers of 4 bytes, 32 bits; code 3: floating point
    head = _chunk(b"fmt ", struct.pack("<HHIIHHH", 3, 1, rate, 4 * rate, 4, 32, 0))
    head += _chunk(b"fact", struct.pack("<I", samples.size))
    entries = (recording.quantity, recording.unit, full_scale)
    comment = json.dumps(dict(zip(COMMENT, entries, strict=True))).encode("ascii")
    information = b"INFO" + _chunk(b"ICMT", comment + b"\0")
    body = b"WAVE" + head + _chunk(b"data", samples.tobytes()) + _chunk(b"LIST", information)
    return _chunk(b"RIFF", body)


def _chunk(name: bytes, content: bytes) -> bytes:
    return name + struct.pack("<I", len(content)) + content + b"\0" * (len(content) % 2)
