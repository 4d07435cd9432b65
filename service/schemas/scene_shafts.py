"""The shafts of a scene: one diameter, several sections, or an inertia."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from service.schemas.model import BoundaryModel, refuse
from service.schemas.scene_bodies import InertiaInput
from service.schemas.scene_types import Coordinate, Name

LENGTHS_AGREE = 1e-6  # relative


class SectionInput(BoundaryModel):
    """A cylindrical piece of a shaft."""

    length_mm: float = Field(gt=0.0, le=1e6, description="Length in mm", examples=[80.0])
    outer_diameter_mm: float = Field(gt=0.0, le=1e5, description="Outer diameter in mm", examples=[40.0])
    bore_diameter_mm: float = Field(
        default=0.0, ge=0.0, le=1e5, description="Bore in mm; 0: solid", examples=[10.0]
    )
    youngs_modulus_gpa: float = Field(
        default=210.0, gt=0.0, le=1e9, description="Young's modulus in GPa", examples=[210.0]
    )
    poissons_ratio: float = Field(
        default=0.3, ge=0.0, le=0.499, description="Poisson's ratio", examples=[0.3]
    )
    density_kg_per_m3: float = Field(
        default=7850.0, gt=0.0, le=1e6, description="Density in kg/m^3", examples=[7850.0]
    )


class ShaftInput(BoundaryModel):
    """A shaft parallel to the z axis; with sections, or a diameter, it can bend and twist."""

    name: Name = Field(description="Name of the shaft", examples=["input"])
    length_mm: float = Field(gt=0.0, le=1e6, description="Length in mm", examples=[200.0])
    origin_mm: Annotated[tuple[Coordinate, ...], Strict(False)] = Field(
        default=(0.0, 0.0, 0.0),
        min_length=3,
        max_length=3,
        description="Left end of the axis, x, y, z in mm",
        examples=[[0.0, 0.0, 0.0]],
    )
    diameter_mm: float | None = Field(
        default=None,
        gt=0.0,
        le=1e5,
        description="Diameter in mm of a solid steel shaft: one section",
        examples=[40.0],
    )
    sections: Annotated[tuple[SectionInput, ...], Strict(False)] | None = Field(
        default=None,
        min_length=1,
        max_length=200,
        description="Pieces of a stepped shaft from its left end, instead of a diameter",
        examples=[[{"length_mm": 200.0, "outer_diameter_mm": 40.0}]],
    )
    inertia: InertiaInput | None = Field(
        default=None,
        description="Inertia of the bare shaft, instead of a diameter: the shaft is rigid",
        examples=[{"mass_kg": 2.0}],
    )
    damping_ratio: float = Field(
        default=0.005,
        ge=0.0,
        le=1.0,
        description="Of the material, in every elastic natural motion of the free shaft",
        examples=[0.005],
    )
    frame: Name | None = Field(
        default=None,
        description="The carrier of the planetary set it belongs to; a carrier names itself",
        examples=["carrier"],
    )

    @model_validator(mode="after")
    def _one_inertia(self) -> Self:
        """Exactly one source of inertia."""
        sources = [part for part in (self.diameter_mm, self.sections, self.inertia) if part is not None]
        if len(sources) != 1:
            bound = "given, or sections or inertia instead, one of the three"
            refuse("diameter_mm", self.diameter_mm, bound, "For example 40.0.")
        if self.sections is not None:
            together = sum(section.length_mm for section in self.sections)
            if abs(together / self.length_mm - 1.0) > LENGTHS_AGREE:
                bound = f"such that the sections are together length_mm, {self.length_mm:g} mm, long"
                lengths = [section.length_mm for section in self.sections]
                refuse("sections", lengths, bound, f"They are {together:g} mm long.")
        return self
