"""Figures of a run that is heard through a housing."""

from __future__ import annotations

from lineofaction.gearbox.schemas.figures import Figures, Part


class Tone(Part):
    """A prominent tone of a steady sound."""

    frequency_hz: float
    tone_to_noise_db: float


class SoundPressure(Part):
    """What the ear makes of a sound pressure; loudness and sharpness need the extra `psychoacoustics`."""

    level_db: float
    level_db_a: float
    steady: bool
    loudness_sone: float | None
    sharpness_acum: float | None
    tones: list[Tone]


class RecordingFigures(Figures):
    """Figures of a run at a microphone, or at a point of a housing."""

    run: str
    quantity: str
    unit: str
    rms: float
    duration_s: float
    sample_rate_hz: int
    full_scale: float
    remark: str
    sound: SoundPressure | None
    other_housings: list[str]


ANSWER = RecordingFigures
