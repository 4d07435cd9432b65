"""Speeds at which the sound of the housings is looked for."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from lineofaction.gearbox.schemas.noise_ranges import NoiseRanges
from lineofaction.gearbox.schemas.speeds import OverSpeedsOrRun


class Inputs(NoiseRanges, OverSpeedsOrRun):
    """Speeds at which the sound of the housings is looked for, the radiation model, and ranges of guesses."""

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
        "0.4 GB for 1600 panels, 10 CPU min and 6 GB for 7000, six edges in a wavelength; every result says "
        "what they would take for its housings; with the extra boundary-elements",
        examples=[True],
    )
