"""Spectra: amplitudes of known sinusoids, peaks between lines, mesh orders, order tracking."""

from __future__ import annotations

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene

from dynamics.errors import InputError
from dynamics.loads import TimeLaw
from dynamics.orders import (
    find_peaks,
    mesh_orders,
    order_track,
    resample_to_position,
    spectrum,
    window_spectrum,
)
from dynamics.orders.spectrum import WINDOWS
from dynamics.simulation import simulate

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
