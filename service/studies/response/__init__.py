"""Speeds at which the forced response is looked for."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, Strict

from service.schemas.speeds import MOST_SPEEDS, Orders, OverSpeeds, TurningSpeed


class Inputs(OverSpeeds):
    """Speeds at which the forced response is looked for."""

    speed_rpm: Annotated[tuple[TurningSpeed, ...], Strict(False)] = Field(
        min_length=1,
        max_length=MOST_SPEEDS,
        description="Speeds of the first driven shaft in rpm, increasing",
        examples=[[300.0, 600.0, 900.0]],
    )
    orders: Orders = Field(default=10, description="Harmonics of the mesh frequency", examples=[10])
