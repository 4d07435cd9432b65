"""Figures of the sound pressure of a run: steady or not, with and without the extra."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest

from dynamics.acoustics import Recording, loudness_over_time
from dynamics.results import RunResult
from lineofaction.gearbox.studies.listen.run import _sound_figures

RATE = 48_000
TIME = np.arange(RATE // 2) / RATE
TONE = 20e-6 * 1e3 * np.sqrt(2.0) * np.sin(2.0 * np.pi * 1000.0 * TIME)
"""60 dB at 1 kHz: 4 sone."""


def recording(samples: np.ndarray = TONE) -> Recording:
    return Recording(samples, RATE, "sound pressure", "Pa")


@pytest.fixture
def steady(run: RunResult) -> RunResult:
    return replace(run, speed=np.broadcast_to([[-40.0], [80.0]], run.speed.shape))


def test_a_steady_tone_of_60_db_has_4_sone_and_is_prominent(steady: RunResult) -> None:
    pytest.importorskip("mosqito", reason="loudness needs the extra psychoacoustics")
    figures = _sound_figures(recording(), steady)
    assert figures.steady
    assert figures.weighted_level == pytest.approx(60.0, abs=0.01)
    assert figures.loudness == pytest.approx(4.02, rel=0.05)
    assert figures.sharpness is not None and 0.5 < figures.sharpness < 1.5
    ((frequency, ratio),) = figures.tones
    assert frequency == pytest.approx(1000.0, abs=5.0) and ratio > 8.0


def test_the_loudness_of_a_run_up_is_exceeded_for_a_twentieth_of_its_time(run: RunResult) -> None:
    pytest.importorskip("mosqito", reason="loudness needs the extra psychoacoustics")
    swelling = recording(TONE * np.linspace(0.0, 1.0, TONE.size) ** 2)
    figures = _sound_figures(swelling, run)
    loudness = loudness_over_time(swelling)[1]
    assert not figures.steady and figures.tones == ()
    assert np.mean(loudness > figures.loudness) == pytest.approx(0.05, abs=0.01)


def test_without_the_extra_the_levels_are_left(steady: RunResult, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mosqito", None)
    figures = _sound_figures(recording(), steady)
    assert figures.level == pytest.approx(60.0, abs=0.01)
    assert figures.loudness is None and figures.sharpness is None
