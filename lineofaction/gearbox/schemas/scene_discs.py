"""Discs on the shafts of a scene that mesh with nothing."""

from __future__ import annotations

from typing import Self

from pydantic import ConfigDict, Field, model_validator

from dynamics.shafts.disc_body import DiscBody
from lineofaction.gearbox.schemas.declared import declared_in, with_fields
from lineofaction.gearbox.schemas.model import BoundaryModel, refuse
from lineofaction.gearbox.schemas.rules import exactly_one_of, stated
from lineofaction.gearbox.schemas.scene_bodies import InertiaInput
from lineofaction.gearbox.schemas.scene_types import Name


class SteelCylinderInput(BoundaryModel):
    """A steel cylinder from which an inertia follows."""

    outer_diameter_mm: float = Field(gt=0.0, le=1e5, description="Outer diameter in mm", examples=[300.0])
    width_mm: float = Field(gt=0.0, le=1e6, description="Width along the axis in mm", examples=[40.0])
    bore_diameter_mm: float = Field(default=0.0, ge=0.0, le=1e5, description="Bore in mm", examples=[40.0])


@with_fields(declared_in(DiscBody))
class DiscInput(BoundaryModel):
    """A flywheel, coupling half or rotor on a shaft."""

    model_config = ConfigDict(json_schema_extra=stated(exactly_one_of("inertia", "cylinder")))

    name: Name = Field(description="Name of the disc", examples=["flywheel"])
    shaft: Name = Field(description="The shaft that carries it", examples=["input"])
    inertia: InertiaInput | None = Field(
        default=None,
        description="Inertia about its center of mass",
        examples=[{"mass_kg": 22.0, "polar_kg_m2": 0.25, "transverse_kg_m2": 0.13}],
    )
    cylinder: SteelCylinderInput | None = Field(
        default=None,
        description="A steel cylinder instead of the inertia",
        examples=[{"outer_diameter_mm": 300.0, "width_mm": 40.0}],
    )

    @model_validator(mode="after")
    def _one_inertia(self) -> Self:
        if (self.inertia is None) == (self.cylinder is None):
            refuse("inertia", self.inertia, "given, or cylinder instead, but not both", "Keep one of them.")
        return self
