"""One-third-octave bands: their edges, their sum, and where a tone falls."""

from __future__ import annotations

import numpy as np
import pytest

from dynamics.errors import InputError
from dynamics.orders import Waterfall, spectrum, third_octaves

RATE, SAMPLES = 20e3, 20_000


def blocks(values):
    """Spectra of the blocks `values` (B, n)."""
    made = spectrum(values, RATE)
    still = np.zeros(values.shape[0])
    return Waterfall(
        made.frequency, still, still, made.amplitude, values.std(axis=-1), "N", made.noise_bandwidth
    )


def tone(frequency, amplitude=2.0):
    return amplitude * np.sin(2.0 * np.pi * frequency * np.arange(SAMPLES) / RATE)[None]


@pytest.mark.parametrize("frequency", [1000.0, 315.0, 250.4, 4900.0])
def test_a_tone_is_in_its_band_with_its_rms(frequency):
    found = third_octaves(blocks(tone(frequency)), 8000.0)
    inside = np.searchsorted(found.edges, frequency) - 1
    assert found.rms[0, inside] == pytest.approx(np.sqrt(2.0), rel=2e-3)
    assert np.delete(found.rms[0], inside).max() < 0.05


def test_centers_are_the_nominal_ones():
    found = third_octaves(blocks(tone(1000.0)), 9000.0)
    assert list(found.nominal[-7:]) == [2000.0, 2500.0, 3150.0, 4000.0, 5000.0, 6300.0, 8000.0]
    assert found.edges[-1] == pytest.approx(8912.5, rel=1e-5)
    np.testing.assert_allclose(found.edges[1:] / found.edges[:-1], 10.0**0.1, rtol=1e-12)


def test_the_bands_add_up_to_the_signal():
    """White noise between the outer edges: as much as the lines there; a band of it grows with its width."""
    noise = np.random.default_rng(3).normal(0.0, 1.0, (40, SAMPLES))
    found = third_octaves(blocks(noise), 9000.0)
    share = (found.edges[-1] - found.edges[0]) / (RATE / 2.0)
    assert np.mean(np.sum(found.rms**2, axis=-1)) == pytest.approx(share, rel=0.005)
    density = np.mean(found.rms**2, axis=0) / np.diff(found.edges)
    np.testing.assert_allclose(density[14:] * RATE / 2.0, 1.0, rtol=0.08)


def test_bands_narrower_than_three_lines_are_left_out():
    found = third_octaves(blocks(tone(1000.0)), 8000.0)
    assert np.diff(found.edges)[0] >= 3.0 > np.diff(found.edges)[0] / 10.0**0.1
    with pytest.raises(InputError, match="top"):
        third_octaves(blocks(tone(1000.0)), 10.0)
