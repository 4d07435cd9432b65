"""Resampling and high-pass of sounds are those of SciPy."""

import numpy as np
import pytest
from scipy.signal import butter, detrend, firwin, resample_poly, sosfiltfilt

from dynamics.acoustics.recording import LOWEST, SLOPE, audible
from dynamics.orders.resampling import KAISER, resampled

SERIES = np.random.default_rng(5).normal(size=(2, 5000)).cumsum(axis=1)
"""Random walks: trends, slow and fast contents."""


@pytest.mark.parametrize(
    ("up", "down", "half_length"),
    [(4, 1, 24), (12, 5, 64), (5, 12, 64), (3, 2, 8), (7001, 9, 2), (9, 7001, 2)],
)
def test_a_series_is_resampled_alike(up, down, half_length):
    steps = max(up, down)
    taps = firwin(2 * half_length * steps + 1, 1.0 / steps, window=("kaiser", KAISER))
    expected = resample_poly(SERIES[0], up, down, window=taps)
    made = resampled(SERIES[0], up, down, half_length)
    assert made.shape == expected.shape
    np.testing.assert_allclose(made, expected, rtol=0.0, atol=1e-12 * np.abs(SERIES).max())


@pytest.mark.parametrize("rate", [1000.0, 20_000.0, 48_000.0])
@pytest.mark.parametrize("size", [4, 47, 48, 2401, 5000])
def test_slow_contents_are_removed_alike(rate, size):
    values = SERIES[:, :size]
    beyond = min(round(rate / LOWEST), size - 1)
    sections = butter(SLOPE, LOWEST, "highpass", fs=rate, output="sos")
    expected = sosfiltfilt(sections, detrend(values), padtype="even", padlen=beyond)
    np.testing.assert_allclose(audible(values, rate), expected, rtol=0.0, atol=1e-12 * np.abs(SERIES).max())
