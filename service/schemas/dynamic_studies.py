"""What the studies of a scene without time integration vary: speeds, orders."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from service.schemas.model import BoundaryModel, refuse

MOST_SPEEDS = 10_000
Speed = Annotated[float, Field(ge=0.0, le=1e7)]
TurningSpeed = Annotated[float, Field(gt=0.0, le=1e7)]
Orders = Annotated[int, Field(ge=1, le=100)]


class ModesInput(BoundaryModel):
    """Speeds at which modes are looked for, beside those at rest."""

    speed_rpm: Annotated[tuple[Speed, ...], Strict(False)] = Field(
        default=(),
        max_length=MOST_SPEEDS,
        description="Speeds of the first shaft that is driven, in rpm, increasing; left out: at rest only",
        examples=[[0.0, 1500.0, 3000.0]],
    )
    orders: Orders = Field(default=10, description="Multiples of the mesh frequencies", examples=[10])
    highest_frequency_hz: float | None = Field(
        default=None,
        gt=0.0,
        le=1e7,
        description="To which shafts are resolved; left out: the highest of the orders at the highest speed",
        examples=[5000.0],
    )

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        """Speeds are an axis."""
        _refuse_unsorted(self.speed_rpm)
        return self


class ResponseInput(BoundaryModel):
    """Speeds at which the forced response is looked for."""

    speed_rpm: Annotated[tuple[TurningSpeed, ...], Strict(False)] = Field(
        min_length=1,
        max_length=MOST_SPEEDS,
        description="Speeds of the first shaft that is driven, in rpm, increasing",
        examples=[[300.0, 600.0, 900.0]],
    )
    orders: Orders = Field(default=10, description="Harmonics of the mesh frequency", examples=[10])

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        """Speeds are an axis."""
        _refuse_unsorted(self.speed_rpm)
        return self


class SteadyInput(BoundaryModel):
    """Speeds at which steady states are looked for."""

    speed_rpm: Annotated[tuple[TurningSpeed, ...], Strict(False)] = Field(
        min_length=1,
        max_length=MOST_SPEEDS,
        description="Speeds of the first shaft that is driven, in rpm, increasing",
        examples=[[11000.0, 12000.0, 13000.0]],
    )
    branch: bool = Field(
        default=True,
        description="Follow the branch from the lowest to the highest speed, with its unstable parts",
        examples=[True],
    )
    repeat: Annotated[int, Field(ge=1, le=16)] = Field(
        default=1, description="Common periods of the meshes after which motions repeat", examples=[1]
    )
    settling_periods: Annotated[int, Field(ge=0, le=100_000)] = Field(
        default=64, description="Periods that a sweep settles for at each speed", examples=[64]
    )

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        """Speeds are an axis."""
        _refuse_unsorted(self.speed_rpm)
        return self


def _refuse_unsorted(values: tuple[float, ...]) -> None:
    """Refuse speeds that do not increase."""
    if any(later <= earlier for earlier, later in pairwise(values)):
        refuse("speed_rpm", list(values)[:8], "strictly increasing", "Sort the list and drop repeats.")
