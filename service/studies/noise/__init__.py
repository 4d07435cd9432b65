"""Speeds at which the sound of the housings is looked for."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, Strict

from service.schemas.noise_ranges import NoiseRanges
from service.schemas.speeds import MOST_SPEEDS, Orders, OverSpeeds, TurningSpeed


class Inputs(NoiseRanges, OverSpeeds):
    """Speeds at which the sound of the housings is looked for, the radiation model, and ranges of guesses."""

    speed_rpm: Annotated[tuple[TurningSpeed, ...], Strict(False)] = Field(
        min_length=1,
        max_length=MOST_SPEEDS,
        description="Speeds of the first driven shaft in rpm, increasing",
        examples=[[300.0, 600.0, 900.0]],
    )
    orders: Orders = Field(default=10, description="Harmonics of the mesh frequency", examples=[10])
    radiation: Literal["monopoles", "equivalent_radiated_power"] = Field(
        default="monopoles",
        description="Radiation model: panels as monopoles that interfere, within 7 dB and mostly too quiet, "
        "10 to 60 CPU s, kept; or as parts of a plane that moves as one: too loud at low frequency, by 10 dB "
        "and more, but at once",
        examples=["monopoles"],
    )
    boundary_elements: bool = Field(
        default=False,
        description="Whether boundary elements check the model where each housing is loudest: 20 CPU s and "
        "more, with the extra boundary-elements",
        examples=[True],
    )
