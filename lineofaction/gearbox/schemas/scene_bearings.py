"""Rolling bearings of a scene: a row of balls or rollers by its geometry, or by its line in a catalog."""

from __future__ import annotations

from typing import Self

from pydantic import ConfigDict, Field, model_validator

from dynamics.bearings import BallBearing, CatalogLine, RollerBearing
from dynamics.bearings.rolling_bearing import RollingBearing
from lineofaction.gearbox.schemas.declared import declared_in, with_fields
from lineofaction.gearbox.schemas.model import BoundaryModel, refuse
from lineofaction.gearbox.schemas.rules import exactly_one_of, stated
from lineofaction.gearbox.schemas.scene_types import Name

ROWS = ("ball", "roller", "catalog")


@with_fields(declared_in(BallBearing))
class BallRowInput(BoundaryModel):
    """A row of balls in grooves: a deep groove ball bearing, or one of angular contact."""


@with_fields(declared_in(RollerBearing))
class RollerRowInput(BoundaryModel):
    """A row of rollers: a cylindrical roller bearing, or a tapered one."""


@with_fields(declared_in(CatalogLine))
class CatalogLineInput(BoundaryModel):
    """The line of a deep groove ball bearing in a catalog, from which its balls are estimated."""


@with_fields(declared_in(RollingBearing))
class RollingBearingInput(BoundaryModel):
    """One row of rolling elements between a shaft and the ground, by its geometry."""

    model_config = ConfigDict(json_schema_extra=stated(exactly_one_of(*ROWS)))

    name: Name = Field(description="Name of the bearing", examples=["input left"])
    shaft: Name = Field(description="The shaft it carries", examples=["input"])
    position_mm: float
    ball: BallRowInput | None = Field(
        default=None,
        description="Its balls and grooves",
        examples=[{"count": 8, "diameter_mm": 11.5, "pitch_diameter_mm": 43.5}],
    )
    roller: RollerRowInput | None = Field(
        default=None,
        description="Its rollers",
        examples=[{"count": 14, "diameter_mm": 9.0, "length_mm": 13.6, "pitch_diameter_mm": 53.5}],
    )
    catalog: CatalogLineInput | None = Field(
        default=None,
        description="Its line in a catalog, a deep groove ball bearing",
        examples=[{"bore_mm": 25.0, "outside_diameter_mm": 62.0, "static_rating_n": 11600.0}],
    )

    @model_validator(mode="after")
    def _one_row(self) -> Self:
        rows = [name for name in ROWS if getattr(self, name) is not None]
        if len(rows) != 1:
            refuse("ball", rows or None, f"given once, as one of {', '.join(ROWS)}", "Keep one of them.")
        return self
