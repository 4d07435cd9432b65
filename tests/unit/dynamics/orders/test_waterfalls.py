"""Waterfalls, order cuts and sidebands of signals in closed form."""

from types import SimpleNamespace

import numpy as np
import pytest

from dynamics.errors import InputError
from dynamics.orders import (
    frequency_waterfall,
    order_track,
    order_waterfall,
    resample_to_position,
    sidebands,
    spectrum,
)

RATE, DURATION, TOP = 20e3, 4.0, 600.0
TEETH = (20, 30)


def run_up(signal, start=0.0):
    """A run whose mesh frequency rises linearly, with `signal(position, time)` as its mesh force."""
    time = np.arange(round(RATE * DURATION) + 1) / RATE
    position = start * time + (TOP - start) * time**2 / (2.0 * DURATION)
    return SimpleNamespace(
        time=time,
        sample_rate=RATE,
        mesh=("mesh",),
        position=(position % 1.0)[None],
        mesh_frequency=(start + (TOP - start) * time / DURATION)[None],
        mesh_force=signal(position, time)[None],
        receipt={"sampling": {"rate": RATE, "pass_frequency": RATE / 2.56}},
        case={
            "gears": [{"name": "pinion", "teeth": TEETH[0]}, {"name": "wheel", "teeth": TEETH[1]}],
            "meshes": [{"driver": "pinion", "driven": "wheel"}],
        },
    )


def chirp(position, _time):
    return 5.0 + 3.0 * np.cos(2 * np.pi * position) + 0.5 * np.sin(6 * np.pi * position + 0.4)


def test_the_order_cut_of_a_chirp_is_its_amplitude():
    found = order_waterfall(run_up(chirp), "mesh_force")
    np.testing.assert_allclose(found.cut(1)[0], 3.0, rtol=3e-5)  # 33 samples per period
    np.testing.assert_allclose(found.cut(3)[0], 0.5, rtol=2.5e-3)  # 11 samples
    np.testing.assert_allclose(found.cut(0)[0], 5.0, rtol=5e-6)
    for empty in (2, 4, 1.5):
        assert found.cut(empty)[0].max() < 1e-4
    assert found.unit == "N"
    np.testing.assert_allclose(found.mesh_frequency, TOP * found.time / DURATION, rtol=1e-6)


def test_an_order_that_grows_with_speed_is_followed():
    found = order_waterfall(run_up(lambda x, t: t * np.cos(4 * np.pi * x)), "mesh_force")
    np.testing.assert_allclose(found.cut(2)[0], found.time, rtol=0.01, atol=0.02)


def test_the_order_track_is_the_cuts_of_the_waterfall():
    run = run_up(chirp)
    track, whole = order_track(run, "mesh_force"), order_waterfall(run, "mesh_force")
    for order in range(11):
        np.testing.assert_array_equal(track.amplitude[..., order], whole.cut(order))


@pytest.mark.parametrize(("order", "error"), [(1, 5e-6), (3, 2e-5), (5, 2e-4), (13, 4e-3)])
def test_resampling_keeps_sinusoids_up_to_the_pass_frequency(order, error):
    """33, 11, 6.7 and 2.56 samples per period."""
    run = run_up(lambda x, _: np.cos(2 * np.pi * order * x), start=TOP)
    grid, _, values = resample_to_position(run, run.mesh_force, 64)
    assert np.abs(values[0] - np.cos(2 * np.pi * order * grid))[100:-100].max() < error


def test_resampling_keeps_a_mean_and_a_slope_to_the_ends():
    run = run_up(lambda x, t: -3000.0 + 400.0 * t, start=TOP)
    _, time, values = resample_to_position(run, run.mesh_force, 64)
    np.testing.assert_allclose(values[0], -3000.0 + 400.0 * time, rtol=4e-6)


def test_the_highest_order_of_the_output_has_its_level_in_the_map():
    found = order_waterfall(run_up(lambda x, _: np.cos(26 * np.pi * x), start=TOP), "mesh_force", highest=13)
    np.testing.assert_allclose(found.cut(13)[0], 1.0, rtol=4e-3)  # 0.04 dB


def test_a_frequency_waterfall_holds_a_resonance_at_its_frequency_and_a_line_at_its_order():
    tone = run_up(lambda x, t: 2.0 * np.sin(2 * np.pi * 1000.0 * t) + np.cos(2 * np.pi * x))
    found = frequency_waterfall(tone, "mesh_force", 0.1)
    assert found.line[1] == pytest.approx(10.0)
    np.testing.assert_allclose(found.cut(1000.0)[0], 2.0, rtol=1e-3)
    below = found.line < 800.0
    highest = found.line[below][np.argmax(found.amplitude[0][:, below][:, 1:], axis=-1) + 1]
    np.testing.assert_allclose(highest, found.mesh_frequency, atol=10.0)


def test_parseval():
    """Half the squared amplitudes and the squared mean are the mean square."""
    values = np.random.default_rng(2).normal(1.0, 3.0, (3, 4096))
    amplitude = spectrum(values, RATE, window="rectangular").amplitude
    power = amplitude[:, 0] ** 2 + 0.5 * np.sum(amplitude[:, 1:-1] ** 2, axis=-1) + amplitude[:, -1] ** 2
    np.testing.assert_allclose(power, np.mean(values**2, axis=-1), rtol=1e-12)


def test_sidebands_of_a_modulation_have_half_its_depth():
    def modulated(position, _time):
        depth = 1.0 + 0.2 * np.cos(2 * np.pi * position / TEETH[0] + 0.3)
        depth += 0.06 * np.cos(2 * np.pi * 2 * position / TEETH[1])
        return depth * np.cos(2 * np.pi * position)

    run = run_up(modulated, start=100.0)
    found = {(s.source, s.mesh_order, s.number): s for s in sidebands(run, run.mesh_force[0])}
    assert len(found) == 2 * 3 * 7
    for number in (-1, 1):
        assert found["pinion", 1, number].amplitude == pytest.approx(0.1, rel=1e-3)
        assert found["pinion", 1, number].order == pytest.approx(1.0 + number / 20)
        assert found["wheel", 1, 2 * number].amplitude == pytest.approx(0.03, rel=2e-2)
    assert found["pinion", 1, 0].amplitude == pytest.approx(1.0, rel=1e-3)
    assert found["pinion", 2, 1].amplitude < 1e-4
    assert found["pinion", 1, 2].amplitude < 2e-3


def test_what_has_no_lines_is_refused():
    run = run_up(chirp)
    with pytest.raises(InputError, match="series"):
        order_waterfall(run, "mesh_forces")
    with pytest.raises(InputError, match="line"):
        order_waterfall(run, "mesh_force").cut(1.03)
    with pytest.raises(InputError, match="block"):
        frequency_waterfall(run, "mesh_force", 5.0)
    with pytest.raises(InputError, match="sidebands of ring"):
        sidebands(run, run.mesh_force[0], periods={"ring": 500})
    with pytest.raises(InputError, match="values"):
        sidebands(run, run.mesh_force)


@pytest.mark.parametrize("window", ["hann", "rectangular", "flat_top"])
def test_the_rms_of_a_block_is_that_of_its_orders(window):
    """Orders on lines: 3 and 0.5 in amplitude, whatever the window."""
    found = order_waterfall(run_up(chirp), "mesh_force", window=window)
    np.testing.assert_allclose(found.rms[0], np.sqrt(0.5 * (3.0**2 + 0.5**2)), rtol=2e-4)
    power = 0.5 * found.amplitude[0, :, 1:] ** 2 / found.noise_bandwidth
    np.testing.assert_allclose(np.sqrt(power.sum(axis=-1)), found.rms[0], rtol=5e-3)
