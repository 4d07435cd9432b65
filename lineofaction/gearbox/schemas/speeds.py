"""Speeds and orders that studies of scenes vary."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Self

from pydantic import ConfigDict, Field, Strict, model_validator

from lineofaction.gearbox.schemas.model import BoundaryModel, refuse
from lineofaction.gearbox.schemas.result_kinds import HASH
from lineofaction.gearbox.schemas.rules import both, given, left_out, stated
from lineofaction.gearbox.schemas.spelling import Spelling

MOST_SPEEDS = 10_000
Speed = Annotated[float, Field(ge=0.0, le=1e7)]
TurningSpeed = Annotated[float, Field(gt=0.0, le=1e7)]
Orders = Annotated[int, Field(ge=1, le=100)]
RunHash = Annotated[str, Field(pattern=HASH)]
_OF_RUN = both(given("run"), {"properties": {"speed_rpm": {"maxItems": 0}}})
_OVER_SPEEDS = both(
    left_out("run"), {"required": ["speed_rpm"], "properties": {"speed_rpm": {"minItems": 1}}}
)


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


class OverSpeedsOrRun(OverOrders):
    """Inputs of a study of mesh orders in the linear response over speeds, or in a run at its own speeds."""

    model_config = ConfigDict(json_schema_extra=stated({"oneOf": [_OF_RUN, _OVER_SPEEDS]}))

    speed_rpm: Annotated[tuple[TurningSpeed, ...], Strict(False)] = Field(
        default=(),
        max_length=MOST_SPEEDS,
        description="Speeds of the first driven shaft in rpm, increasing; a run has its own",
        examples=[[300.0, 600.0, 900.0]],
    )
    run: Annotated[RunHash | None, Spelling("--run", file=True)] = Field(
        default=None,
        description="Run of the scene whose bearing forces are taken in place of the linear response, at its "
        "speeds",
    )

    @model_validator(mode="after")
    def _speeds_or_run(self) -> Self:
        """Refuse both and neither."""
        if self.run is not None and self.speed_rpm:
            shown = list(self.speed_rpm)[:8]
            refuse("speed_rpm", shown, "left out with a run", "The run has its own speeds.")
        if self.run is None and not self.speed_rpm:
            refuse("speed_rpm", [], "at least one speed, if no run is given", "For example 300, 600 and 900.")
        return self
