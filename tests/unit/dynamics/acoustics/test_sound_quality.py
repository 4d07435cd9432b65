"""Psychoacoustics against the definitions of sone and acum, and what has no loudness."""

import sys

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from dynamics.acoustics import Recording, loudness_over_time, sound_quality
from dynamics.errors import InputError
from host import MissingExtra

RATE = 48_000
TIME = np.arange(RATE) / RATE
WITH_LIBRARY = "sound quality needs the extra psychoacoustics"


def scaled(samples: np.ndarray, level: float) -> Recording:
    """Sound pressure of a level in dB re 20 uPa."""
    return Recording(20e-6 * 10.0 ** (level / 20.0) * samples / samples.std(), RATE, "sound pressure", "Pa")


def tone(level: float, frequency: float = 1000.0) -> Recording:
    return scaled(np.sin(2.0 * np.pi * frequency * TIME), level)


@pytest.fixture(autouse=True, scope="module")
def _library():
    pytest.importorskip("mosqito", reason=WITH_LIBRARY)


@pytest.mark.parametrize(
    ("frequency", "level", "sone"),
    [(1000.0, 40.0, 1.0), (1000.0, 60.0, 4.019), (250.0, 80.0, 14.655), (4000.0, 40.0, 1.549)],
)
def test_tones_have_the_loudness_of_the_standard(frequency, level, sone):
    """The definition of the sone and the test signals of ISO 532-1, annex B.3, whose tolerance is 5 %."""
    assert sound_quality(tone(level, frequency)).loudness == pytest.approx(sone, rel=0.05)


def test_one_acum_is_a_critical_band_about_one_kilohertz_at_60_decibels():
    noise = np.random.default_rng(8).normal(size=2 * RATE)
    band = sosfilt(butter(8, [920.0, 1080.0], "bandpass", fs=RATE, output="sos"), noise)[RATE:]
    assert sound_quality(scaled(band, 60.0)).sharpness == pytest.approx(1.0, abs=0.05)


def test_a_tone_in_noise_is_found_and_noise_alone_has_none():
    noise = np.random.default_rng(9).normal(size=RATE)
    mixed = sound_quality(scaled(noise + 1.0 * np.sin(2.0 * np.pi * 2000.0 * TIME), 60.0))
    assert mixed.tone_frequency == pytest.approx([2000.0], abs=3.0)
    assert sound_quality(scaled(noise, 60.0)).tone_frequency.size == 0


def test_loudness_over_time_follows_the_sound():
    rising = tone(60.0).samples[: RATE // 2] * np.where(TIME[: RATE // 2] < 0.25, 0.1, 1.0)
    time, loudness = loudness_over_time(Recording(rising, RATE, "sound pressure", "Pa"))
    assert time.shape == loudness.shape
    early, late = (loudness[np.searchsorted(time, at)] for at in (0.2, 0.45))
    assert late / early == pytest.approx(4.0, rel=0.1)


def test_only_a_sound_pressure_has_a_loudness(monkeypatch):
    with pytest.raises(InputError, match=r"unit.*Pa"):
        sound_quality(Recording(TIME, RATE, "bearing force", "N"))
    with pytest.raises(InputError, match=r"resampled\(48000\)"):
        sound_quality(Recording(TIME, 20_000, "sound pressure", "Pa"))
    monkeypatch.setitem(sys.modules, "mosqito", None)
    with pytest.raises(MissingExtra, match=r"lineofaction\[psychoacoustics\]"):
        sound_quality(tone(60.0))


@pytest.mark.parametrize("samples", [2, 20, 200])
def test_a_sound_of_a_few_milliseconds_has_no_loudness(samples):
    brief = Recording(TIME[:samples], RATE, "sound pressure", "Pa")
    for metric in (sound_quality, loudness_over_time):
        with pytest.raises(InputError, match="duration"):
            metric(brief)
