"""A run as it is heard through the housings of a scene: recording, figures, and what they leave out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from dynamics.acoustics import Recording
from dynamics.results import RunResult
from dynamics.types import FloatArray
from lineofaction.gearbox.studies.listen.sound_figures import SoundFigures, driving_shaft, sound_figures
from lineofaction.gearbox.studies.listen.through_housing import SceneHousings

Json = dict[str, Any]
KIND, SCHEMA = "recording", "lineofaction recording"
"""Of its files: kind of the result, and attribute."""
NO_LOUDNESS = "loudness is that of a sound pressure alone"
FREE_FIELD = (
    "free field: no room, floor or attached parts; the air is at rest and does not act back. Panels as "
    "monopoles neither scatter nor shadow: at one place mostly 7 dB too low to 2 dB too high, and lower "
    "where the housing is larger than the wavelength"
)
POINTS = 200
"""Of the way along an axis."""


@dataclass(frozen=True)
class Receiver:
    """Where a run is heard: at a microphone (mm) in the frame of the scene, or at a point of a housing.

    `direction` is one of `DIRECTIONS` in `through_housing`; empty: in which the point moves most.
    """

    microphone_mm: tuple[float, ...] = ()
    point: str = ""
    direction: str = ""


@dataclass(frozen=True)
class HeardRun:
    """A run through the housings of a scene.

    Attributes
    ----------
    run : str
        Its name, or its content hash.
    recording : Recording
    figures : SoundFigures or None
        Of a sound pressure.
    other_housings : tuple of str
        Housings that the scene of the run did not have so.
    time, speed : (n,) arrays
        s; of the driving gear of the first mesh, rad/s.
    """

    run: str
    recording: Recording
    figures: SoundFigures | None
    other_housings: tuple[str, ...]
    time: FloatArray
    speed: FloatArray

    @property
    def remarks(self) -> tuple[str, ...]:
        """What the recording leaves out."""
        own = NO_LOUDNESS if self.figures is None else FREE_FIELD
        return (own, *(warning["message"] for warning in self.warnings))

    @property
    def remark(self) -> str:
        """The remarks as one text."""
        return "; ".join(self.remarks)

    @property
    def warnings(self) -> list[Json]:
        """Warnings of housings that the scene of the run did not have so."""
        message = (
            'run {}: it did not move in housing "{}" as the scene has it; its forces lack what that does'
        )
        return [
            {"check": "other_housing", "message": message.format(self.run, name)}
            for name in self.other_housings
        ]


def heard_run(name: str, run: RunResult, housings: SceneHousings, receiver: Receiver) -> HeardRun:
    """Return a run as a receiver hears it.

    Raises
    ------
    BadInput
        As `SceneHousings.pressure` and `velocity`.
    """
    time = np.linspace(float(run.time[0]), float(run.time[-1]), POINTS)
    speed = np.interp(time, run.time, np.abs(run.speed[run.shaft.index(driving_shaft(run, 0))]))
    if receiver.point:
        recording, figures = housings.velocity(run, receiver.point, receiver.direction), None
    else:
        recording = housings.pressure(run, receiver.microphone_mm)
        figures = sound_figures(recording, run)
    return HeardRun(name, recording, figures, housings.strangers(run), time - time[0], speed)


def recording_facts(recording: Recording) -> Json:
    """Return what a recording holds, in its unit."""
    return {
        "quantity": recording.quantity,
        "unit": recording.unit,
        "rms": rms(recording),
        "duration_s": recording.samples.size / recording.sample_rate,
        "sample_rate_hz": recording.sample_rate,
    }


def rms(recording: Recording) -> float:
    """Return the root mean square of a recording."""
    return math.sqrt(float((recording.samples**2).mean()))


def sound_facts(heard: HeardRun) -> Json:
    """Return the figures of a sound pressure as JSON, under their name; nothing of a velocity."""
    figures = heard.figures
    if figures is None:
        return {}
    tones = [{"frequency_hz": hertz, "tone_to_noise_db": ratio} for hertz, ratio in figures.tones]
    facts = {
        "level_db": figures.level,
        "level_db_a": figures.weighted_level,
        "steady": figures.steady,
        "loudness_sone": figures.loudness,
        "sharpness_acum": figures.sharpness,
        "tones": tones,
    }
    return {"sound": facts}
