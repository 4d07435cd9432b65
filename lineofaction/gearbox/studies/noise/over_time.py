"""Sound power over the time of a run, all that it holds: figures and the plot of its third octaves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from dynamics.acoustics import sound_power_level
from dynamics.acoustics.run_recording import LOWEST
from dynamics.noise import HousingRadiation, SoundOverTime, sound_over_time
from dynamics.noise.sound_over_time import BLOCK
from dynamics.results import RunResult
from dynamics.types import FloatArray
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.units import RPM

Json = dict[str, Any]


def run_frequencies(run: RunResult, frequency: FloatArray) -> FloatArray:
    """Return frequencies of orders (S, H) with the ends of what is heard of a run, Hz."""
    ends = [LOWEST, float(run.receipt["sampling"]["pass_frequency"])]
    return np.append(frequency.ravel(), ends)


def over_time(
    subject: TabledScene, run: RunResult, radiation: Mapping[str, HousingRadiation]
) -> SoundOverTime | None:
    """Return the sound power of all housings over a run; None where it is shorter than a block."""
    if run.time.size < BLOCK * run.sample_rate:
        return None
    sounds = [
        sound_over_time(run, subject.housings[part.name], part.bushings, radiation[part.name])
        for part in subject.scene.housings
        if part.name in radiation
    ]
    return SoundOverTime.of_all(sounds)


def over_time_json(sound: SoundOverTime | None) -> Json | None:
    """Return levels over time in the units of the boundary."""
    if sound is None:
        return None
    return {
        "time_s": sound.time.tolist(),
        "speed_rpm": (sound.speed / RPM).tolist(),
        "third_octave_hz": sound.nominal.tolist(),
        "third_octave_db": sound_power_level(sound.power.T).tolist(),
        "total_level_db": sound.total_level.tolist(),
        "total_level_db_a": sound.total_weighted_level.tolist(),
        "lowest_hz": sound.lowest,
        "highest_hz": sound.highest,
    }
