"""Level of a recorded sound pressure: calibrator, sums, A-weighting of tones, what is no pressure."""

from __future__ import annotations

import numpy as np
import pytest

from dynamics.acoustics import Recording, a_weighting, sound_pressure_level
from dynamics.errors import InputError

RATE = 48_000
TIME = np.arange(RATE) / RATE


def tone(frequency: float, level: float) -> np.ndarray:
    return np.asarray(np.sqrt(2.0) * 20e-6 * 10.0 ** (level / 20.0) * np.sin(2.0 * np.pi * frequency * TIME))


def level(samples: np.ndarray, *, weighted: bool = False) -> float:
    return sound_pressure_level(Recording(samples, RATE, "sound pressure", "Pa"), weighted=weighted)


def test_a_calibrator_of_1_pa_has_94_db_weighted_or_not() -> None:
    samples = np.sqrt(2.0) * np.sin(2.0 * np.pi * 1000.0 * TIME)
    assert level(samples) == pytest.approx(93.98, abs=0.005)
    assert level(samples, weighted=True) == pytest.approx(93.98, abs=0.005)


@pytest.mark.parametrize("frequency", [50.0, 100.0, 4000.0])
def test_a_tone_is_weighted_by_its_frequency(frequency: float) -> None:
    expected = 80.0 + float(a_weighting(frequency))
    assert level(tone(frequency, 80.0), weighted=True) == pytest.approx(expected, abs=1e-6)


def test_two_equal_tones_have_3_db_more() -> None:
    assert level(tone(300.0, 60.0) + tone(700.0, 60.0)) == pytest.approx(
        60.0 + 10.0 * np.log10(2.0), abs=1e-6
    )


@pytest.mark.parametrize("samples", [999, 1000])
def test_it_is_that_of_the_mean_square(samples: int) -> None:
    noise = np.random.default_rng(1).normal(size=samples)
    assert level(noise) == pytest.approx(10.0 * np.log10(np.mean(noise**2) / 4e-10), abs=1e-9)


def test_silence_has_a_level_and_a_force_has_none() -> None:
    assert level(np.zeros(100)) == -200.0
    with pytest.raises(InputError, match="that of a sound pressure"):
        sound_pressure_level(Recording(TIME, RATE, "bearing force", "N"))
