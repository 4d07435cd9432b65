"""Inputs and figures of a run that is heard through the housings of a scene."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from lineofaction.gearbox.schemas.figures import Figures, Part, Source
from lineofaction.gearbox.schemas.model import BoundaryModel, Coordinate, Row, refuse
from lineofaction.gearbox.schemas.rules import all_of, at_most_one_of
from lineofaction.gearbox.schemas.studied import RunHash

Position = Annotated[Row[Coordinate], Field(min_length=3, max_length=3)]
_PLACES = ("microphone_mm", "point")
ONE_RECEIVER = "given, or point, one of both"
REMEDY = "A microphone hears the sound pressure, a point its velocity."
_TONE = ("frequency", "tone_to_noise")


class Inputs(BoundaryModel):
    """A run, the scene whose housings it moves, and the microphone or point."""

    model_config = ConfigDict(json_schema_extra=all_of(at_most_one_of(*_PLACES)))

    run: RunHash = Field(
        description="Run whose forces on bearings move the housings of the scene", examples=["0" * 64]
    )
    microphone_mm: Position | None = Field(
        default=None,
        description="Microphone of the sound pressure in a free field, in mm in the frame of the scene; "
        "default without a point: the microphone of the scene's complaint",
        examples=[[40.0, 60.0, 1000.0]],
    )
    point: str | None = Field(
        default=None, min_length=1, max_length=255, description="Point of a housing whose velocity is heard"
    )
    direction: Literal["x", "y", "z", "principal"] | None = Field(
        default=None, description="Direction at the point; default: in which it varies most"
    )

    @model_validator(mode="after")
    def _one_receiver(self) -> Self:
        """Refuse both places, and a direction of a sound pressure."""
        names = [name for name in _PLACES if getattr(self, name) is not None]
        if len(names) > 1:
            refuse("microphone_mm", names, ONE_RECEIVER, REMEDY)
        if self.direction is not None and self.point is None:
            refuse("direction", self.direction, "left out with microphone_mm", "A pressure has none.")
        return self


class SoundPressure(Part):
    """Figures of hearing a sound pressure; loudness and sharpness need the extra `psychoacoustics`."""

    class Tone(Part):
        """A prominent tone of a steady sound."""

        frequency_hz: float
        tone_to_noise_db: float

    level_db: Annotated[float, Source("level")]
    level_db_a: Annotated[float, Source("weighted_level")]
    steady: bool
    loudness_sone: Annotated[float | None, Source("loudness")]
    sharpness_acum: Annotated[float | None, Source("sharpness")]
    tones: Annotated[
        list[Tone], Source(lambda sound: [dict(zip(_TONE, tone, strict=True)) for tone in sound.tones])
    ]


class ListenFigures(Figures):
    """Figures of a run at a microphone, or at a point of a housing."""

    run: str
    full_scale: float
    remark: str
    quantity: str
    unit: str
    rms: float
    duration_s: float
    sample_rate_hz: int
    sound: Annotated[SoundPressure | None, Source("figures")]
    other_housings: list[str]
