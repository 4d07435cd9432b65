"""Speeds at which a housing's vibration is looked for, and where its parts are."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, Strict

from service.schemas.speeds import MOST_SPEEDS, Orders, OverSpeeds, TurningSpeed


class Inputs(OverSpeeds):
    """Speeds at which a housing's vibration is looked for, and where its parts are."""

    speed_rpm: Annotated[tuple[TurningSpeed, ...], Strict(False)] = Field(
        min_length=1,
        max_length=MOST_SPEEDS,
        description="Speeds of the first driven shaft in rpm, increasing",
        examples=[[300.0, 600.0, 900.0]],
    )
    orders: Orders = Field(default=10, description="Harmonics of the mesh frequency", examples=[10])
    housing: str | None = Field(
        default=None, max_length=255, description="Name of the housing; default: the first with a surface"
    )
    at_rpm: float | None = Field(
        default=None,
        gt=0.0,
        le=1e7,
        description="Speed at which contributions and deflection are shown, the nearest of those computed; "
        "default: where the motion is largest",
    )
    at_order: float | None = Field(
        default=None,
        gt=0.0,
        le=1e4,
        description="Order for which they are shown, the nearest; default: that of the largest motion",
    )
    mode: int | None = Field(
        default=None,
        ge=1,
        le=2000,
        description="Natural mode of the housing to draw in place of the operating deflection",
    )
