"""Loudness, sharpness and tonality of a sound pressure, by MoSQITo (extra `psychoacoustics`).

References
----------
.. [1] ISO 532-1:2017, Methods for calculating loudness - Part 1: Zwicker method.
.. [2] DIN 45692:2009, Measurement technique for the simulation of the auditory sensation of sharpness.
.. [3] ECMA-418-1:2022, Psychoacoustic metrics for ITT equipment - Part 1: prominent discrete tones.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from bounds import at_least, exactly
from dynamics.acoustics.levels import FLOOR, REFERENCE_PRESSURE, a_weighting
from dynamics.acoustics.recording import SAMPLE_RATE, Recording
from dynamics.errors import InputError
from dynamics.types import FloatArray
from host import MissingExtra

SHORTEST = 0.01
"""Shortest sound that has a loudness, s."""
STEADY = 0.01
"""Largest change of speed of a steady sound, over the largest speed."""
EXCEEDED = 5.0
"""Percent of the time for which the loudness of a changing sound is exceeded: N5 of ISO 532-1."""


def sound_pressure_level(recording: Recording, *, weighted: bool = False) -> float:
    """Return the level of the root mean square over a recording re 20 uPa, dB or dB(A); at least `FLOOR`.

    The equivalent continuous level of ISO 1996-1. `weighted`: whether A-weighted. Raises `InputError`: it is
    no sound pressure in Pa.
    """
    if recording.unit != "Pa":
        raise InputError("unit", recording.unit, "Pa", "Its level is that of a sound pressure.")
    samples = recording.samples
    lines = np.abs(np.fft.rfft(samples) / samples.size) ** 2
    lines[1 : (samples.size + 1) // 2] *= 2.0  # Parseval: all but the mean and the Nyquist line stand for two
    if weighted:
        lines *= 10.0 ** (a_weighting(np.fft.rfftfreq(samples.size, 1.0 / recording.sample_rate)) / 10.0)
    lowest = 10.0 ** (FLOOR / 10.0)
    return float(10.0 * np.log10(max(lines.sum() / REFERENCE_PRESSURE**2, lowest)))


@dataclass(frozen=True)
class _SoundQuality:
    """Metrics of a stationary sound."""

    loudness: float
    """Loudness in the free field, sone: 1 for a tone of 1 kHz at 40 dB."""
    sharpness: float
    """Sharpness, acum: 1 for a band of noise, a critical band wide about 1 kHz, at 60 dB."""
    tone_frequency: FloatArray
    tone_to_noise: FloatArray
    """`tone_frequency`, `tone_to_noise`: Frequencies, Hz, and tone-to-noise ratios, dB, of the prominent
    tones. Shape (K,) each.
    """


def sound_quality(recording: Recording) -> _SoundQuality:
    """Return the metrics of a sound that does not change over the recording.

    Raises `InputError`: it is no sound pressure in Pa at 48 kHz (loudness is no linear quantity, a force has
    none), or shorter than `SHORTEST`; `MissingExtra`: MoSQITo is not installed.
    """
    metrics = _metrics(recording)
    loudness, specific, _ = metrics.loudness_zwst(recording.samples, recording.sample_rate)
    sharpness = metrics.sharpness_din_from_loudness(loudness, specific) if loudness > 0.0 else 0.0
    _, tones, _, frequency = metrics.tnr_ecma_st(recording.samples, recording.sample_rate, prominence=True)
    return _SoundQuality(
        float(loudness), float(sharpness), np.asarray(frequency, float), np.asarray(tones, float)
    )


def loudness_over_time(recording: Recording) -> tuple[FloatArray, FloatArray]:
    """Return times (B,) in s and the loudness (B,) in sone of a sound that changes, e.g. of a run-up.

    Raises `InputError` or `MissingExtra` as `sound_quality` does.
    """
    metrics = _metrics(recording)
    loudness, _, _, time = metrics.loudness_zwtv(recording.samples, recording.sample_rate)
    return np.asarray(time), np.asarray(loudness)


def _metrics(recording: Recording) -> Any:
    if recording.unit != "Pa":
        raise InputError("unit", recording.unit, "Pa", "Loudness is that of a sound pressure.")
    if recording.sample_rate != SAMPLE_RATE:
        remedy = f"Use recording.resampled({SAMPLE_RATE})."
        raise InputError("sample_rate", recording.sample_rate, exactly(SAMPLE_RATE, " Hz"), remedy)
    if recording.samples.size < SHORTEST * SAMPLE_RATE:
        raise InputError("duration", recording.samples.size / SAMPLE_RATE, at_least(SHORTEST, "s"))
    try:
        from mosqito import sq_metrics  # noqa: PLC0415 (an extra)
    except ModuleNotFoundError as error:
        raise MissingExtra(error.name or "mosqito", "psychoacoustics") from None
    return sq_metrics


@dataclass(frozen=True)
class SoundFigures:
    """Figures of a sound pressure."""

    level: float
    weighted_level: float
    """`level`, `weighted_level`: Level of the rms over the whole run, dB and dB(A) re 20 uPa."""
    steady: bool
    """Whether the speed is constant."""
    loudness: float | None = None
    """Loudness in the free field, sone; that of a changing sound is exceeded for 5 % of the time. None: not
    computed.
    """
    sharpness: float | None = None
    """Sharpness of the mean spectrum, acum."""
    tones: tuple[tuple[float, float], ...] = ()
    """Frequency, Hz, and tone-to-noise ratio, dB, of the prominent tones of a steady sound."""


def is_steady(speed: FloatArray) -> bool:
    """Whether a machine sounds alike all the time, by its speed (n,) without sign."""
    return bool(np.ptp(speed) <= STEADY * speed.max())


def sound_figures(recording: Recording, *, steady: bool) -> SoundFigures:
    """Return the figures of a sound pressure; of a very short one, or without MoSQITo, its levels alone."""
    level, weighted = (sound_pressure_level(recording, weighted=by_ear) for by_ear in (False, True))
    if recording.samples.size < SHORTEST * recording.sample_rate:
        return SoundFigures(level, weighted, steady)
    try:
        quality = sound_quality(recording)
        loudness = quality.loudness
        if not steady:
            loudness = float(np.percentile(loudness_over_time(recording)[1], 100.0 - EXCEEDED))
    except MissingExtra:
        return SoundFigures(level, weighted, steady)
    tones = zip(quality.tone_frequency.tolist(), quality.tone_to_noise.tolist(), strict=True)
    return SoundFigures(level, weighted, steady, loudness, quality.sharpness, tuple(tones) if steady else ())
