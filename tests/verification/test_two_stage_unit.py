"""A gearbox from its REXS file to the sound of its case before and after `optimize`, by the verbs."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from dynamics.acoustics import free_field_pressure, read_wav
from dynamics.acoustics.air import Air
from dynamics.noise import RadiatedSound

SCRIPT = Path(__file__).parents[2] / "examples" / "two_stage" / "unit.py"


def mean_square(sound: RadiatedSound) -> float:
    """Return the mean square pressure at 1 m over an even run through the speeds of a map, Pa^2."""
    pressure = free_field_pressure(sound.orders.power, 1.0, Air().impedance)
    between = (pressure[:, 1:] ** 2 + pressure[:, 1:] * pressure[:, :-1] + pressure[:, :-1] ** 2) / 3.0
    steps = np.diff(sound.speed)
    return float(np.sum(between * steps) / np.sum(steps))


@pytest.mark.nightly
def test_the_unit_is_cast_deflected_optimized_and_heard(tmp_path: Path) -> None:
    command = [sys.executable, SCRIPT, "-o", tmp_path, "--quick"]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    rows = {
        row[0]: (float(row[1]), float(row[2])) for row in re.findall(r"(.+?) +([\d.]+) +([\d.]+)\n", printed)
    }
    assert "optimized: second stage" in printed
    before, after = rows["second stage, peak-to-peak STE, um"]
    assert after < 0.9 * before
    before, after = rows["first stage, peak-to-peak STE, um"]
    assert after == pytest.approx(before, rel=0.02)

    sounds = {name: RadiatedSound.from_netcdf(tmp_path / name / "sound.nc") for name in ("before", "after")}
    loudest = [sound.orders.total_weighted_level.max() for sound in sounds.values()]
    assert rows["loudest of all speeds"] == pytest.approx(loudest, abs=0.051)
    for name, sound in sounds.items():
        recording = read_wav(tmp_path / f"{name}.wav")
        assert recording.unit == "Pa"
        level = 10.0 * np.log10(np.mean(recording.samples**2) / mean_square(sound))
        assert abs(level) < 0.1, name
    for file in ("modes.png", "modes.vtu", "velocity.png", "velocity.vtu", "before/sound/sound_map.png"):
        assert (tmp_path / file).stat().st_size > 1000, file
