"""Speeds and orders that studies of scenes vary."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Self

from pydantic import Field, model_validator

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
