"""A gearbox from its REXS file to the sound of its case before and after `optimize`, by the verbs."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from wav_files import read_wav

from dynamics.acoustics import Air, free_field_pressure
from dynamics.noise import RadiatedSound
from dynamics.types import FloatArray

SECOND = 21.0 / 63.0
"""Mesh frequency of the second stage over that of the first: teeth of its pinion over those of wheel 1."""
SCRIPT = Path(__file__).parents[2] / "examples" / "two_stage" / "unit.py"


def mean_square(sound: RadiatedSound) -> float:
    """Return the mean square pressure at 1 m over an even run through the speeds of a map, Pa^2."""
    pressure = free_field_pressure(sound.orders.power, 1.0, Air().impedance)
    between = (pressure[:, 1:] ** 2 + pressure[:, 1:] * pressure[:, :-1] + pressure[:, :-1] ** 2) / 3.0
    steps = np.diff(sound.speed)
    return float(np.sum(between * steps) / np.sum(steps))


def order_change(before: RadiatedSound, after: RadiatedSound) -> float:
    """Return the change of the second stage's mesh order where it is loudest, dB."""
    old, new = (sound.orders.weighted_level[order_of(sound)].max() for sound in (before, after))
    return float(new - old)


def bearing_changes(before: RadiatedSound, after: RadiatedSound) -> FloatArray:
    """Return the change of what each bearing's force in this order radiates, at the speed of the most, dB."""
    old, new = (sound.bearing_alone[:, :, order_of(sound)].max(axis=1) for sound in (before, after))
    return np.asarray(10.0 * np.log10(new / old))


def order_of(sound: RadiatedSound) -> int:
    """Return the index of the second stage's mesh order."""
    return int(np.flatnonzero(np.abs(sound.order - SECOND) < 1e-9)[0])


@pytest.mark.nightly
def test_the_unit_is_cast_deflected_optimized_and_heard(tmp_path):
    command = [sys.executable, SCRIPT, "-o", tmp_path, "--quick"]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    rows = {
        row[0]: (float(row[1]), float(row[2])) for row in re.findall(r"(.+?) +([\d.]+) +([\d.]+)\n", printed)
    }
    assert "optimized: second stage" in printed
    before, after = rows["second stage, harmonic 1 when heard, µm"]
    excited = 20.0 * np.log10(after / before)
    before, after = rows["first stage, peak-to-peak STE, µm"]
    assert after == pytest.approx(before, rel=0.02)

    sounds = {name: RadiatedSound.from_netcdf(tmp_path / name / "sound.nc") for name in ("before", "after")}
    peaks = [sound.orders.total_weighted_level.max() for sound in sounds.values()]
    assert rows["loudest of all speeds"] == pytest.approx(peaks, abs=0.051)
    assert peaks[1] < peaks[0] - 5.0
    of_ste = [RadiatedSound.from_netcdf(tmp_path / name / "sound_of_ste.nc") for name in sounds]
    assert order_change(*of_ste) == pytest.approx(excited, abs=0.5)
    assert np.all(bearing_changes(*of_ste) < excited + 0.5)
    assert order_change(*sounds.values()) < min(excited, 0.0) - 3.0
    assert "this order is quieter by it" in printed
    for name, sound in sounds.items():
        recording = read_wav(tmp_path / f"{name}.wav")
        assert recording.unit == "Pa"
        level = 10.0 * np.log10(np.mean(recording.samples**2) / mean_square(sound))
        assert abs(level) < 0.1, name
    for file in ("mode_1.png", "velocity.png", "velocity.vtu", "before/sound/sound_map.png"):
        assert (tmp_path / file).stat().st_size > 1000, file
