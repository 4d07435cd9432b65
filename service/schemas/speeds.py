"""Speeds and orders that studies of scenes vary."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from service.schemas.model import BoundaryModel, refuse

MOST_SPEEDS = 10_000
Speed = Annotated[float, Field(ge=0.0, le=1e7)]
TurningSpeed = Annotated[float, Field(gt=0.0, le=1e7)]
Orders = Annotated[int, Field(ge=1, le=100)]


class OverSpeeds(BoundaryModel):
    """Inputs of a study over speeds, which are an axis."""

    speed_rpm: tuple[float, ...]

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        """Refuse speeds that do not increase."""
        if any(later <= earlier for earlier, later in pairwise(self.speed_rpm)):
            shown = list(self.speed_rpm)[:8]
            refuse("speed_rpm", shown, "strictly increasing", "Sort the list and drop repeats.")
        return self


class OverOrders(OverSpeeds):
    """Inputs of a study of mesh orders over speeds at which the shafts turn."""

    speed_rpm: Annotated[tuple[TurningSpeed, ...], Strict(False)] = Field(
        min_length=1,
        max_length=MOST_SPEEDS,
        description="Speeds of the first driven shaft in rpm, increasing",
        examples=[[300.0, 600.0, 900.0]],
    )
    orders: Orders = Field(default=10, description="Harmonics of the mesh frequency", examples=[10])
