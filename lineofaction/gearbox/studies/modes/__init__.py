"""Speeds at which modes are looked for."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, Strict

from lineofaction.gearbox.schemas.speeds import MOST_SPEEDS, Orders, OverSpeeds, Speed


class Inputs(OverSpeeds):
    """Speeds at which modes are looked for, beside those at rest."""

    speed_rpm: Annotated[tuple[Speed, ...], Strict(False)] = Field(
        default=(),
        max_length=MOST_SPEEDS,
        description="Speeds of the first driven shaft in rpm, increasing; default: at rest only",
        examples=[[0.0, 1500.0, 3000.0]],
    )
    orders: Orders = Field(default=10, description="Multiples of the mesh frequencies", examples=[10])
    highest_frequency_hz: float | None = Field(
        default=None,
        gt=0.0,
        le=1e7,
        description="Highest frequency for flexible shafts; default: the highest order at the highest speed",
        examples=[5000.0],
    )
