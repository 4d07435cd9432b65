"""Forces of a run as recordings: the orders of the file have the levels of the map, nothing is added."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from wav_files import read_wav

from dynamics.acoustics import (
    audible,
    common_full_scale,
    force_recording,
    principal_direction,
    series_recording,
    write_wav,
)
from dynamics.errors import InputError
from dynamics.orders import order_waterfall
from dynamics.results import RunResult

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


@pytest.mark.parametrize(("start", "end"), [(250.0, 250.0), (60.0, 900.0), (900.0, 60.0)])
def test_orders_of_the_file_have_the_levels_of_the_map(tmp_path: Path, start: float, end: float) -> None:
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


def test_the_direction_is_the_line_of_action() -> None:
    run = run_of(300.0, 300.0)
    axis, share = principal_direction(run.bearing_force[0], RATE)
    np.testing.assert_allclose(axis, ACTION, atol=1e-12)
    assert share == pytest.approx(1.0, abs=1e-12)
    heard = force_recording(run, "left")
    assert heard.quantity == "force on bearing left along (0.342, 0.940, 0.000); no sound pressure"
    assert heard.unit == "N"
    across = force_recording(run, "left", np.array([2.0, 0.0, 0.0]))
    np.testing.assert_allclose(across.samples, ACTION[0] * heard.samples, atol=1e-9 * heard.peak)


def test_a_direction_of_noise_takes_its_share_of_the_variance() -> None:
    """Two uncorrelated tones at right angles, powers 9 to 1."""
    time = np.arange(20_000) / RATE
    force = np.stack([np.sin(2e3 * np.pi * time), 3.0 * np.cos(3e3 * np.pi * time), 0.0 * time])
    axis, share = principal_direction(force, RATE)
    np.testing.assert_allclose(axis, [0.0, 1.0, 0.0], atol=1e-3)
    assert share == pytest.approx(0.9, abs=1e-3)


def test_a_sine_keeps_its_amplitude_and_its_duration() -> None:
    time = np.arange(round(RATE) + 1) / RATE
    heard = series_recording(123.0 + 7.0 * np.sin(2.0 * np.pi * 440.0 * time), RATE, "force", "N")
    inner = heard.samples[4800:-4800]
    assert np.sqrt(2.0 * np.mean(inner**2)) == pytest.approx(7.0, rel=1e-3)
    assert heard.samples.size / heard.sample_rate == pytest.approx(1.0, abs=1.0 / RATE)
    assert heard.samples[0] == 0.0
    assert abs(heard.samples[-1]) < 1e-3


def test_what_is_slow_is_not_in_the_file_and_what_is_heard_is() -> None:
    time = np.arange(round(4.0 * RATE)) / RATE
    slow = audible(5000.0 * time + 100.0 * np.sin(2.0 * np.pi * 2.0 * time), RATE)
    inner = slice(round(RATE), round(3.0 * RATE))
    assert np.abs(slow[inner]).max() < 0.01
    assert np.abs(audible(5000.0 * time, RATE)).max() < 1e-6, "nor at the ends"
    heard = audible(np.sin(2.0 * np.pi * 36.0 * time), RATE)
    assert np.abs(heard[inner]).max() == pytest.approx(1.0, rel=TENTH_DB)


def test_of_two_designs_the_ratio_is_that_of_the_forces(tmp_path: Path) -> None:
    loud, quiet = (force_recording(run_of(200.0, 400.0, scale), "left") for scale in (1.0, 0.3))
    scale = common_full_scale(loud, quiet)
    for name, one in (("loud", loud), ("quiet", quiet)):
        write_wav(tmp_path / f"{name}.wav", one, scale)
    first, second = (read_wav(tmp_path / f"{name}.wav").samples for name in ("loud", "quiet"))
    # the load is the same: what a slow rise leaves at the ends is not scaled
    inner = slice(9600, -9600)
    np.testing.assert_allclose(second[inner], 0.3 * first[inner], atol=2e-4 * scale)


@pytest.mark.parametrize("rate", [8192.0, 23_459.0, 48_000.0, 65_536.5, 192_000.0])
def test_every_output_rate_becomes_the_rate_of_the_file(rate: float) -> None:
    time = np.arange(round(0.5 * rate)) / rate
    heard = series_recording(np.sin(2.0 * np.pi * 1000.0 * time), rate, "force", "N")
    at = np.arange(heard.samples.size) / heard.sample_rate
    inner = slice(4800, -4800)
    np.testing.assert_allclose(heard.samples[inner], np.sin(2.0 * np.pi * 1000.0 * at)[inner], atol=1e-3)


def test_what_has_no_sound_is_refused() -> None:
    run = run_of(200.0, 200.0, duration=0.1)
    with pytest.raises(InputError, match=r'bearing.*middle.*"left", "right"'):
        force_recording(run, "middle")
    with pytest.raises(InputError, match=r"direction.*not all zero"):
        force_recording(run, "left", np.zeros(3))
    with pytest.raises(InputError, match="It is silent"):
        principal_direction(np.zeros((3, 100)), RATE)
    with pytest.raises(InputError, match="above 40"):
        audible(np.zeros(100), 30.0)
    run.bearing_force = np.empty((0, 3, run.time.size))  # type: ignore[misc]
    with pytest.raises(InputError, match=r"outputs\.bearing_forces = true"):
        force_recording(run, "left")
