"""Speeds at which steady states are looked for."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, Strict

from lineofaction.gearbox.schemas.speeds import MOST_SPEEDS, OverSpeeds, TurningSpeed


class Inputs(OverSpeeds):
    """Speeds at which steady states are looked for."""

    speed_rpm: Annotated[tuple[TurningSpeed, ...], Strict(False)] = Field(
        min_length=1,
        max_length=MOST_SPEEDS,
        description="Speeds of the first driven shaft in rpm, increasing",
        examples=[[11000.0, 12000.0, 13000.0]],
    )
    branch: bool = Field(
        default=True,
        description="Follow the branch of solutions from the lowest to the highest speed, unstable parts "
        "included",
        examples=[True],
    )
    repeat: Annotated[int, Field(ge=1, le=16)] = Field(
        default=1, description="Period of the motions in common periods of the meshes", examples=[1]
    )
    settling_periods: Annotated[int, Field(ge=0, le=100_000)] = Field(
        default=64, description="Periods of settling at each speed of a sweep", examples=[64]
    )
