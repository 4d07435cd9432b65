"""What the ear makes of the sound pressure of a run: levels, loudness, sharpness, prominent tones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.acoustics import Recording, loudness_over_time, sound_pressure_level, sound_quality
from dynamics.acoustics.sound_quality import SHORTEST
from dynamics.orders import leading_shaft
from dynamics.results import RunResult
from host import MissingExtra

STEADY = 0.01
"""Largest change of speed of a steady sound, of the speed."""
EXCEEDED = 5.0
"""Percent of the time for which the loudness of a changing sound is exceeded: N5 of ISO 532-1."""


@dataclass(frozen=True)
class SoundFigures:
    """Figures of a sound pressure.

    Attributes
    ----------
    level, weighted_level : float
        Of the rms over the whole run, dB and dB(A) re 20 uPa.
    steady : bool
        Whether the speed is constant.
    loudness : float or None
        sone, in the free field; of a changing sound that exceeded for 5 % of the time. None: not computed.
    sharpness : float or None
        acum, of the mean spectrum.
    tones : tuple of (float, float)
        Hz and tone-to-noise ratio in dB of the prominent tones of a steady sound.
    """

    level: float
    weighted_level: float
    steady: bool
    loudness: float | None = None
    sharpness: float | None = None
    tones: tuple[tuple[float, float], ...] = ()


def sound_figures(recording: Recording, run: RunResult) -> SoundFigures:
    """Return the figures of a sound pressure; of a very short one, or without MoSQITo, its levels alone."""
    level, weighted = (sound_pressure_level(recording, weighted=by_ear) for by_ear in (False, True))
    steady = _steady(run)
    if recording.samples.size < SHORTEST * recording.sample_rate:
        return SoundFigures(level, weighted, steady)
    try:
        quality = sound_quality(recording)
        loudness = quality.loudness if steady else _exceeded(recording)
    except MissingExtra:
        return SoundFigures(level, weighted, steady)
    found = zip(quality.tone_frequency.tolist(), quality.tone_to_noise.tolist(), strict=True)
    return SoundFigures(level, weighted, steady, loudness, quality.sharpness, tuple(found) if steady else ())


def _steady(run: RunResult) -> bool:
    """Whether the driving gear of the first mesh turns at one speed."""
    speed = np.abs(run.speed[run.shaft.index(driving_shaft(run, 0))])
    return bool(np.ptp(speed) <= STEADY * speed.max())


def _exceeded(recording: Recording) -> float:
    """Return the loudness that is exceeded for 5 % of the time, sone."""
    return float(np.percentile(loudness_over_time(recording)[1], 100.0 - EXCEEDED))


def driving_shaft(run: RunResult, mesh: int) -> str:
    """Name of the shaft that carries the driving gear; without gears of the first that is driven."""
    if not run.mesh:
        return leading_shaft(run)
    driver = run.case["meshes"][mesh]["driver"]
    return str(next(gear["shaft"] for gear in run.case["gears"] if gear["name"] == driver))
