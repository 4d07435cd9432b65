"""Spectra of orders, and their bands of a third octave."""

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene

from dynamics import TimeLaw, mesh_orders, simulate
from dynamics.errors import InputError
from dynamics.orders import (
    Waterfall,
    find_peaks,
    order_track,
    resample_to_position,
    spectrum,
    third_octaves,
    window_spectrum,
)
from dynamics.orders.spectrum import WINDOWS

# Spectra: amplitudes of known sinusoids, peaks between lines, mesh orders, order tracking.


RATE = 1000.0
TIME = np.arange(2000) / RATE


@pytest.mark.parametrize("window", WINDOWS)
def test_a_sinusoid_on_a_line_has_its_amplitude_and_the_mean_is_kept(window):
    found = spectrum(3.0 + 2.0 * np.sin(2 * np.pi * 50.0 * TIME + 0.3), RATE, "N", window)
    assert found.resolution == 0.5
    assert found.amplitude[100] == pytest.approx(2.0, rel=1e-9)
    assert found.amplitude[0] == pytest.approx(3.0, rel=1e-9)
    assert found.unit == "N"


def test_scalloping_is_as_stated():
    between = spectrum(np.sin(2 * np.pi * 50.25 * TIME), RATE).amplitude.max()
    assert 20 * np.log10(between) == pytest.approx(-1.42, abs=0.03)
    between = spectrum(np.sin(2 * np.pi * 50.25 * TIME), RATE, window="flat_top").amplitude.max()
    assert abs(20 * np.log10(between)) < 0.02


def test_the_nyquist_line_is_not_doubled():
    assert spectrum(np.cos(np.pi * np.arange(64)), 1.0, window="rectangular").amplitude[-1] == pytest.approx(
        1.0
    )


def test_many_signals_at_once():
    signals = np.stack([np.sin(2 * np.pi * f * TIME) for f in (20.0, 40.0, 60.0)]).reshape(3, 1, -1)
    found = spectrum(signals, RATE).amplitude
    assert found.shape == (3, 1, 1001)
    assert np.argmax(found, axis=-1).ravel().tolist() == [40, 80, 120]


def test_peaks_are_found_between_lines_and_ordered():
    signal = np.sin(2 * np.pi * 50.2 * TIME) + 0.5 * np.sin(2 * np.pi * 120.4 * TIME) + 9.0
    first, second = find_peaks(spectrum(signal, RATE), 2)
    assert first.frequency == pytest.approx(50.2, abs=0.02)
    assert first.amplitude == pytest.approx(1.0, rel=0.03)
    assert second.frequency == pytest.approx(120.4, abs=0.02)
    assert find_peaks(spectrum(signal, RATE), 1, low=100.0)[0].frequency == pytest.approx(120.4, abs=0.02)


@pytest.fixture(scope="module")
def run_up():
    return simulate(gear_pair_scene(speed=TimeLaw.ramp(300.0 * RPM, 900.0 * RPM, 0.5), duration=0.5))


def test_mesh_orders_run_with_the_speed(run_up):
    first, second = mesh_orders(run_up, 0.25, 0.5, 2)
    assert (first.low, first.high) == (pytest.approx(200.0, rel=1e-3), pytest.approx(300.0, rel=1e-3))
    assert (second.order, second.low) == (2, pytest.approx(400.0, rel=1e-3))


def test_resampling_to_position_undoes_a_run_up(run_up):
    """A signal that is a function of position alone has equal amplitudes of its orders at every speed."""
    signal = np.cos(2 * np.pi * run_up.position) + 0.25 * np.sin(6 * np.pi * run_up.position)
    position, time, values = resample_to_position(run_up, signal)
    np.testing.assert_allclose(np.diff(position), 1 / 64, rtol=1e-9)
    assert np.all(np.diff(time) > 0.0)
    expected = np.cos(2 * np.pi * position) + 0.25 * np.sin(6 * np.pi * position)
    np.testing.assert_allclose(values[0], expected, atol=5e-3)


def test_order_amplitudes_of_the_static_error_do_not_depend_on_speed(run_up):
    track = order_track(run_up, "static_transmission_error", pitches=8, highest=3)
    assert track.amplitude.shape == (1, track.time.size, 4)
    for order in (1, 2, 3):
        amplitudes = track.amplitude[0, :, order]
        np.testing.assert_allclose(amplitudes, amplitudes.mean(), rtol=0.01)
    assert np.all(np.diff(track.mesh_frequency) > 0.0)


def test_what_cannot_be_done_is_refused(run_up):
    with pytest.raises(InputError, match="series"):
        window_spectrum(run_up, "temperature", 0.1, 0.2)
    with pytest.raises(InputError, match="of one signal"):
        find_peaks(window_spectrum(run_up, "bearing_force", 0.1, 0.2))
    with pytest.raises(InputError, match="pitches"):
        order_track(run_up, "mesh_force", pitches=10_000)
    with pytest.raises(InputError, match="values"):
        spectrum(np.ones(3), 1.0)


# One-third-octave bands: their edges, their sum, and where a tone falls.


BAND_RATE, SAMPLES = 20e3, 20_000


def blocks(values):
    """Spectra of the blocks `values` (B, n)."""
    made = spectrum(values, BAND_RATE)
    still = np.zeros(values.shape[0])
    return Waterfall(
        made.frequency, still, still, made.amplitude, values.std(axis=-1), "N", made.noise_bandwidth
    )


def tone(frequency, amplitude=2.0):
    return amplitude * np.sin(2.0 * np.pi * frequency * np.arange(SAMPLES) / BAND_RATE)[None]


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
    share = (found.edges[-1] - found.edges[0]) / (BAND_RATE / 2.0)
    assert np.mean(np.sum(found.rms**2, axis=-1)) == pytest.approx(share, rel=0.005)
    density = np.mean(found.rms**2, axis=0) / np.diff(found.edges)
    np.testing.assert_allclose(density[14:] * BAND_RATE / 2.0, 1.0, rtol=0.08)


def test_bands_narrower_than_three_lines_are_left_out():
    found = third_octaves(blocks(tone(1000.0)), 8000.0)
    assert np.diff(found.edges)[0] >= 3.0 > np.diff(found.edges)[0] / 10.0**0.1
    with pytest.raises(InputError, match="top"):
        third_octaves(blocks(tone(1000.0)), 10.0)
