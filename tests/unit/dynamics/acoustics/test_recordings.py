"""Recordings: the levels of orders in the file, resampling, full scale, true relative level."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.io import wavfile
from wav_files import read_wav

from dynamics.acoustics import Recording, common_full_scale, order_recording, write_wav
from dynamics.errors import InputError, ResultError
from dynamics.orders import spectrum

RATE = 48_000
ORDERS = np.array([20.0, 40.0, 57.5])
PEAKS = np.array([0.02, 0.3, 0.004])


def levels(samples: np.ndarray, frequency: np.ndarray, rate: int = RATE) -> np.ndarray:
    """Levels re 1 of the lines at frequencies in Hz, by a flat top window."""
    lines = spectrum(samples, float(rate), window="flat_top")
    at = np.round(frequency / lines.resolution).astype(int)
    return 20.0 * np.log10(np.array([lines.amplitude[k - 2 : k + 3].max() for k in at]))


@pytest.mark.parametrize("revolutions", [25.0, 83.3])
def test_a_file_has_the_levels_of_its_orders(tmp_path, revolutions: float) -> None:
    time = np.array([0.0, 0.7, 2.0])
    frequency = np.outer(ORDERS * revolutions, np.ones(3))
    made = order_recording(time, frequency, np.outer(PEAKS * np.exp([0j, 1j, 2j]), np.ones(3)), "p", "Pa")
    write_wav(tmp_path / "a.wav", made, 1.0)
    heard = read_wav(tmp_path / "a.wav")
    assert (heard.quantity, heard.unit, heard.sample_rate) == ("p", "Pa", RATE)
    np.testing.assert_allclose(levels(heard.samples, ORDERS * revolutions), 20.0 * np.log10(PEAKS), atol=0.1)


def test_orders_of_a_run_up_have_their_levels_at_every_speed() -> None:
    """The amplitude is that of the speed, the phase the integral of the frequency: demodulated by it."""
    time = np.linspace(0.0, 10.0, 21)
    frequency = np.outer(ORDERS, 20.0 + 3.0 * time + 0.4 * time**2)
    amplitude = np.outer(PEAKS, 1.0 + 0.1 * time)
    made = order_recording(time, frequency, amplitude, "p", "Pa")
    at = np.arange(made.samples.size) / RATE
    fine = np.interp(at, time, frequency[1])
    turn = np.exp(-2j * np.pi * np.concatenate([[0.0], np.cumsum(0.5 * (fine[1:] + fine[:-1])) / RATE]))
    for start in (1.0, 5.0, 8.5):
        part = slice(int(start * RATE), int((start + 0.5) * RATE))
        found = 2.0 * abs(np.mean(made.samples[part] * turn[part]))
        expected = np.interp(start + 0.25, time, amplitude[1])
        assert 20.0 * np.log10(found / expected) == pytest.approx(0.0, abs=0.1)


@pytest.mark.parametrize("rate", [20_000, 44_100, 96_000])
def test_resampling_keeps_levels_and_removes_what_would_fold(rate: int) -> None:
    lower = min(rate, RATE)
    frequency = np.round(np.array([0.05, 0.3, 0.45]) * lower, -1)
    at = np.arange(2 * rate) / rate
    tones = sum(np.cos(2.0 * np.pi * f * at) for f in frequency)
    kept = Recording(tones, rate, "v", "m/s").resampled()
    assert kept.sample_rate == RATE
    assert kept.samples.size == pytest.approx(2 * RATE, abs=2)
    inner = kept.samples[RATE // 2 : -RATE // 2]
    np.testing.assert_allclose(levels(inner, frequency), 0.0, atol=0.02)


def test_what_lies_above_the_new_rate_does_not_fold_back() -> None:
    at = np.arange(192_000) / 96_000
    folded = Recording(np.cos(2.0 * np.pi * 0.55 * RATE * at), 96_000, "v", "m/s").resampled()
    assert np.abs(folded.samples[RATE // 2 : -RATE // 2]).max() < 10.0 ** (-70.0 / 20.0)


def test_two_files_keep_their_relative_level(tmp_path) -> None:
    loud, quiet = (Recording(peak * np.sin(np.arange(999.0)), RATE, "force", "N") for peak in (80.0, 20.0))
    scale = common_full_scale(loud, quiet)
    assert scale == loud.peak
    for name, recording in (("loud", loud), ("quiet", quiet)):
        write_wav(tmp_path / f"{name}.wav", recording, scale)
    (_, first), (_, second) = (wavfile.read(tmp_path / f"{name}.wav") for name in ("loud", "quiet"))
    assert first.dtype == np.float32
    assert np.abs(first).max() == pytest.approx(1.0)
    np.testing.assert_allclose(second, 0.25 * first, rtol=1e-6)
    np.testing.assert_allclose(read_wav(tmp_path / "quiet.wav").samples, quiet.samples, atol=1e-5)
    with pytest.raises(InputError, match="the same of all"):
        common_full_scale(loud, Recording(np.ones(9), RATE, "p", "Pa"))


def test_nothing_is_clipped_and_no_other_file_read(tmp_path) -> None:
    with pytest.raises(InputError, match=r"full_scale.*recording's peak"):
        write_wav(tmp_path / "a.wav", Recording(np.array([0.0, 2.0]), RATE, "p", "Pa"), 1.0)
    wavfile.write(tmp_path / "plain.wav", RATE, np.zeros(8, dtype=np.float32))
    with pytest.raises(ResultError, match=r"plain\.wav is no WAV file with quantity"):
        read_wav(tmp_path / "plain.wav")
    (tmp_path / "text.wav").write_bytes(b"no sound")
    with pytest.raises(ResultError, match=r"text\.wav"):
        read_wav(tmp_path / "text.wav")
    with pytest.raises(InputError, match="at most 21600"):
        order_recording(np.array([0.0, 1.0]), np.full((1, 2), 22e3), np.ones((1, 2)), "p", "Pa")
    with pytest.raises(InputError, match="finite"):
        Recording(np.array([0.0, np.nan]), RATE, "p", "Pa")
