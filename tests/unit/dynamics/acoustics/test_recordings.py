"""Recordings: of spectra as WAV, and of bearing forces of runs."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from scipy.io import wavfile
from wav_files import read_wav

from dynamics.acoustics import (
    Recording,
    audible,
    common_full_scale,
    force_recording,
    order_recording,
    principal_direction,
    series_recording,
    write_wav,
)
from dynamics.errors import InputError, ResultError
from dynamics.orders import order_waterfall, spectrum
from dynamics.results import RunResult

# Recordings: the levels of orders in the file, resampling, full scale, true relative level.


WAV_RATE = 48_000
ORDERS = np.array([20.0, 40.0, 57.5])
WAV_PEAKS = np.array([0.02, 0.3, 0.004])


def levels(samples: np.ndarray, frequency: np.ndarray, rate: int = WAV_RATE) -> np.ndarray:
    """Levels re 1 of the lines at frequencies in Hz, by a flat top window."""
    lines = spectrum(samples, float(rate), window="flat_top")
    at = np.round(frequency / lines.resolution).astype(int)
    return 20.0 * np.log10(np.array([lines.amplitude[k - 2 : k + 3].max() for k in at]))


@pytest.mark.parametrize("revolutions", [25.0, 83.3])
def test_a_file_has_the_levels_of_its_orders(tmp_path, revolutions):
    time = np.array([0.0, 0.7, 2.0])
    frequency = np.outer(ORDERS * revolutions, np.ones(3))
    made = order_recording(time, frequency, np.outer(WAV_PEAKS * np.exp([0j, 1j, 2j]), np.ones(3)), "p", "Pa")
    write_wav(tmp_path / "a.wav", made, 1.0)
    heard = read_wav(tmp_path / "a.wav")
    assert (heard.quantity, heard.unit, heard.sample_rate) == ("p", "Pa", WAV_RATE)
    np.testing.assert_allclose(
        levels(heard.samples, ORDERS * revolutions), 20.0 * np.log10(WAV_PEAKS), atol=0.1
    )


def test_orders_of_a_run_up_have_their_levels_at_every_speed():
    """The amplitude is that of the speed, the phase the integral of the frequency: demodulated by it."""
    time = np.linspace(0.0, 10.0, 21)
    frequency = np.outer(ORDERS, 20.0 + 3.0 * time + 0.4 * time**2)
    amplitude = np.outer(WAV_PEAKS, 1.0 + 0.1 * time)
    made = order_recording(time, frequency, amplitude, "p", "Pa")
    at = np.arange(made.samples.size) / WAV_RATE
    fine = np.interp(at, time, frequency[1])
    turn = np.exp(-2j * np.pi * np.concatenate([[0.0], np.cumsum(0.5 * (fine[1:] + fine[:-1])) / WAV_RATE]))
    for start in (1.0, 5.0, 8.5):
        part = slice(int(start * WAV_RATE), int((start + 0.5) * WAV_RATE))
        found = 2.0 * abs(np.mean(made.samples[part] * turn[part]))
        expected = np.interp(start + 0.25, time, amplitude[1])
        assert 20.0 * np.log10(found / expected) == pytest.approx(0.0, abs=0.1)


@pytest.mark.parametrize("rate", [20_000, 44_100, 96_000])
def test_resampling_keeps_levels_and_removes_what_would_fold(rate):
    lower = min(rate, WAV_RATE)
    frequency = np.round(np.array([0.05, 0.3, 0.45]) * lower, -1)
    at = np.arange(2 * rate) / rate
    tones = sum(np.cos(2.0 * np.pi * f * at) for f in frequency)
    kept = Recording(tones, rate, "v", "m/s").resampled()
    assert kept.sample_rate == WAV_RATE
    assert kept.samples.size == pytest.approx(2 * WAV_RATE, abs=2)
    inner = kept.samples[WAV_RATE // 2 : -WAV_RATE // 2]
    np.testing.assert_allclose(levels(inner, frequency), 0.0, atol=0.02)


def test_what_lies_above_the_new_rate_does_not_fold_back():
    at = np.arange(192_000) / 96_000
    folded = Recording(np.cos(2.0 * np.pi * 0.55 * WAV_RATE * at), 96_000, "v", "m/s").resampled()
    assert np.abs(folded.samples[WAV_RATE // 2 : -WAV_RATE // 2]).max() < 10.0 ** (-70.0 / 20.0)


def test_two_files_keep_their_relative_level(tmp_path):
    loud, quiet = (
        Recording(peak * np.sin(np.arange(999.0)), WAV_RATE, "force", "N") for peak in (80.0, 20.0)
    )
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
        common_full_scale(loud, Recording(np.ones(9), WAV_RATE, "p", "Pa"))


def test_nothing_is_clipped_and_no_other_file_read(tmp_path):
    with pytest.raises(InputError, match=r"full_scale.*recording's peak"):
        write_wav(tmp_path / "a.wav", Recording(np.array([0.0, 2.0]), WAV_RATE, "p", "Pa"), 1.0)
    wavfile.write(tmp_path / "plain.wav", WAV_RATE, np.zeros(8, dtype=np.float32))
    with pytest.raises(ResultError, match=r"plain\.wav is no WAV file with quantity"):
        read_wav(tmp_path / "plain.wav")
    (tmp_path / "text.wav").write_bytes(b"no sound")
    with pytest.raises(ResultError, match=r"text\.wav"):
        read_wav(tmp_path / "text.wav")
    with pytest.raises(InputError, match="at most 21600"):
        order_recording(np.array([0.0, 1.0]), np.full((1, 2), 22e3), np.ones((1, 2)), "p", "Pa")
    with pytest.raises(InputError, match="finite"):
        Recording(np.array([0.0, np.nan]), WAV_RATE, "p", "Pa")


# Forces of a run as recordings: the orders of the file have the levels of the map, nothing is added.


RATE, DURATION, PITCHES = 20_480.0, 3.0, 16
ACTION = np.array([np.sin(np.radians(20.0)), np.cos(np.radians(20.0)), 0.0])
PEAKS = {1: 40.0, 2: 8.0, 5: 0.9}  # N
TENTH_DB = 10.0 ** (0.1 / 20.0) - 1.0


def run_of(start: float, end: float, scale: float = 1.0, duration: float = DURATION) -> RunResult:
    """A run whose mesh frequency goes from `start` to `end` Hz; its orders pass a resonance at 700 Hz."""
    time = np.arange(round(RATE * duration) + 1) / RATE
    mesh = start + (end - start) * time / duration
    position = start * time + (end - start) * time**2 / (2.0 * duration)
    force = -3000.0 + 200.0 * time / duration  # the load, slowly rising
    for order, peak in PEAKS.items():
        gain = 1.0 + 4.0 / (1.0 + ((order * mesh - 700.0) / 90.0) ** 2)
        force = force + scale * peak * gain * np.cos(2.0 * np.pi * order * position + order)
    along = np.stack([ACTION[0] * force, ACTION[1] * force, 0.0 * force])
    run = SimpleNamespace(
        time=time,
        sample_rate=RATE,
        mesh=("mesh",),
        bearing=("left", "right"),
        position=(position % 1.0)[None],
        mesh_frequency=mesh[None],
        bearing_force=np.stack([along, 0.5 * along]),
        receipt={"sampling": {"rate": RATE, "pass_frequency": RATE / 2.56}},
    )
    return cast(RunResult, run)


def heard_order(samples: np.ndarray, rate: int, run: RunResult, order: int, at: float) -> float:
    """Amplitude of an order in a file about a time: Fourier over the base pitches of a block of the map."""
    time = np.arange(samples.size) / rate
    position = np.interp(time, run.time, np.unwrap(run.position[0], period=1.0))
    middle = np.interp(at, time, position)
    phase = (position - middle) / PITCHES
    weight = np.where(np.abs(phase) < 0.5, 0.5 + 0.5 * np.cos(2.0 * np.pi * phase), 0.0)
    weight = weight * np.gradient(position)  # over position, not over time
    turned = np.exp(-2j * np.pi * order * position)
    return float(2.0 * abs(np.sum(weight * samples * turned)) / weight.sum())


@pytest.mark.law
@pytest.mark.parametrize(("start", "end"), [(250.0, 250.0), (60.0, 900.0), (900.0, 60.0)])
def test_orders_of_the_file_have_the_levels_of_the_map(tmp_path, start, end):
    run = run_of(start, end)
    recording = force_recording(run, "left")
    write_wav(tmp_path / "left.wav", recording, common_full_scale(recording))
    file = read_wav(tmp_path / "left.wav")
    made = order_waterfall(run, "bearing_force", PITCHES, 5)
    for block in np.linspace(1, made.time.size - 2, 6).astype(int):
        middle = run.time[np.searchsorted(np.unwrap(run.position[0], period=1.0), (block + 0.5) * PITCHES)]
        for order in PEAKS:
            in_map = float(np.linalg.norm(made.cut(order)[0, :, block]))
            in_file = heard_order(file.samples, file.sample_rate, run, order, float(middle))
            assert in_file == pytest.approx(in_map, rel=TENTH_DB), (order, middle)


def test_the_direction_is_the_line_of_action():
    run = run_of(300.0, 300.0)
    axis, share = principal_direction(run.bearing_force[0], RATE)
    np.testing.assert_allclose(axis, ACTION, atol=1e-12)
    assert share == pytest.approx(1.0, abs=1e-12)
    heard = force_recording(run, "left")
    assert heard.quantity == "force on bearing left along (0.342, 0.940, 0.000); no sound pressure"
    assert heard.unit == "N"
    across = force_recording(run, "left", np.array([2.0, 0.0, 0.0]))
    np.testing.assert_allclose(across.samples, ACTION[0] * heard.samples, atol=1e-9 * heard.peak)


def test_a_direction_of_noise_takes_its_share_of_the_variance():
    """Two uncorrelated tones at right angles, powers 9 to 1."""
    time = np.arange(20_000) / RATE
    force = np.stack([np.sin(2e3 * np.pi * time), 3.0 * np.cos(3e3 * np.pi * time), 0.0 * time])
    axis, share = principal_direction(force, RATE)
    np.testing.assert_allclose(axis, [0.0, 1.0, 0.0], atol=1e-3)
    assert share == pytest.approx(0.9, abs=1e-3)


def test_a_sine_keeps_its_amplitude_and_its_duration():
    time = np.arange(round(RATE) + 1) / RATE
    heard = series_recording(123.0 + 7.0 * np.sin(2.0 * np.pi * 440.0 * time), RATE, "force", "N")
    inner = heard.samples[4800:-4800]
    assert np.sqrt(2.0 * np.mean(inner**2)) == pytest.approx(7.0, rel=1e-3)
    assert heard.samples.size / heard.sample_rate == pytest.approx(1.0, abs=1.0 / RATE)
    assert heard.samples[0] == 0.0
    assert abs(heard.samples[-1]) < 1e-3


def test_what_is_slow_is_not_in_the_file_and_what_is_heard_is():
    time = np.arange(round(4.0 * RATE)) / RATE
    slow = audible(5000.0 * time + 100.0 * np.sin(2.0 * np.pi * 2.0 * time), RATE)
    inner = slice(round(RATE), round(3.0 * RATE))
    assert np.abs(slow[inner]).max() < 0.01
    assert np.abs(audible(5000.0 * time, RATE)).max() < 1e-6, "nor at the ends"
    heard = audible(np.sin(2.0 * np.pi * 36.0 * time), RATE)
    assert np.abs(heard[inner]).max() == pytest.approx(1.0, rel=TENTH_DB)


def test_of_two_designs_the_ratio_is_that_of_the_forces(tmp_path):
    loud, quiet = (force_recording(run_of(200.0, 400.0, scale), "left") for scale in (1.0, 0.3))
    scale = common_full_scale(loud, quiet)
    for name, one in (("loud", loud), ("quiet", quiet)):
        write_wav(tmp_path / f"{name}.wav", one, scale)
    first, second = (read_wav(tmp_path / f"{name}.wav").samples for name in ("loud", "quiet"))
    # the load is the same: what a slow rise leaves at the ends is not scaled
    inner = slice(9600, -9600)
    np.testing.assert_allclose(second[inner], 0.3 * first[inner], atol=2e-4 * scale)


@pytest.mark.parametrize("rate", [8192.0, 23_459.0, 48_000.0, 65_536.5, 192_000.0])
def test_every_output_rate_becomes_the_rate_of_the_file(rate):
    time = np.arange(round(0.5 * rate)) / rate
    heard = series_recording(np.sin(2.0 * np.pi * 1000.0 * time), rate, "force", "N")
    at = np.arange(heard.samples.size) / heard.sample_rate
    inner = slice(4800, -4800)
    np.testing.assert_allclose(heard.samples[inner], np.sin(2.0 * np.pi * 1000.0 * at)[inner], atol=1e-3)


def test_what_has_no_sound_is_refused():
    run = run_of(200.0, 200.0, duration=0.1)
    with pytest.raises(InputError, match=r'bearing.*middle.*"left", "right"'):
        force_recording(run, "middle")
    with pytest.raises(InputError, match=r"direction.*not all zero"):
        force_recording(run, "left", np.zeros(3))
    with pytest.raises(InputError, match="It is silent"):
        principal_direction(np.zeros((3, 100)), RATE)
    with pytest.raises(InputError, match="above 40"):
        audible(np.zeros(100), 30.0)
    run.bearing_force = np.empty((0, 3, run.time.size))
    with pytest.raises(InputError, match=r"outputs\.bearing_forces = true"):
        force_recording(run, "left")
