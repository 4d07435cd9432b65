"""The shafts of a scene: one diameter, several sections, or an inertia."""

from __future__ import annotations

from typing import Self

from pydantic import ConfigDict, Field, model_validator

from dynamics.shafts.beam_section import BeamSection
from dynamics.shafts.shaft import Shaft
from lineofaction.gearbox.schemas.bodies import LENGTHS_AGREE, InertiaInput
from lineofaction.gearbox.schemas.declared import declared_in, with_fields
from lineofaction.gearbox.schemas.model import BoundaryModel, Coordinate, Listed, Name, Point, refuse
from lineofaction.gearbox.schemas.rules import all_of, exactly_one_of


@with_fields(declared_in(BeamSection))
class SectionInput(BoundaryModel):
    """A cylindrical or conical piece of a shaft."""

    length_mm: float


@with_fields(declared_in(Shaft))
class ShaftInput(BoundaryModel):
    """A shaft parallel to the z axis; with sections, or a diameter, it can bend and twist."""

    model_config = ConfigDict(json_schema_extra=all_of(exactly_one_of("diameter_mm", "sections", "inertia")))

    name: Name = Field(description="Name of the shaft", examples=["input"])
    length_mm: float
    origin_mm: Point = Field(
        default=(0.0, 0.0, 0.0), description="Left end of the axis, x, y, z in mm", examples=[[0.0, 0.0, 0.0]]
    )
    diameter_mm: float | None = Field(
        default=None,
        gt=0.0,
        le=1e5,
        description="Diameter in mm of a solid steel shaft: one section",
        examples=[40.0],
    )
    sections: Listed[SectionInput] | None = Field(
        default=None,
        min_length=1,
        max_length=200,
        description="Sections of a stepped shaft from its left end, instead of a diameter",
        examples=[[{"length_mm": 200.0, "outer_diameter_mm": 40.0}]],
    )
    inertia: InertiaInput | None = Field(
        default=None,
        description="Inertia of the bare shaft, instead of a diameter: the shaft is rigid",
        examples=[{"mass_kg": 2.0, "polar_kg_m2": 4e-4, "transverse_kg_m2": 7e-3}],
    )
    frame: Name | None = Field(
        default=None,
        description="The carrier of the planetary set it belongs to; a carrier names itself",
        examples=["carrier"],
    )
    tooth_angles_deg: Listed[Coordinate] | None = Field(
        default=None,
        min_length=1,
        max_length=100,
        description="Angles about +z of the center of a tooth of each of its gears at mid-face, in their "
        "order, in degrees; left out: in line",
        examples=[[0.0, 4.5]],
    )

    @model_validator(mode="after")
    def _one_inertia(self) -> Self:
        sources = [part for part in (self.diameter_mm, self.sections, self.inertia) if part is not None]
        if len(sources) != 1:
            bound = "given, or sections or inertia instead, one of the three"
            refuse("diameter_mm", self.diameter_mm, bound, "For example 40.0.")
        if self.sections is not None:
            lengths = [section.length_mm for section in self.sections]
            together = sum(lengths)
            if abs(together / self.length_mm - 1.0) > LENGTHS_AGREE:
                bound = f"such that the sections are together length_mm, {self.length_mm:g} mm, long"
                refuse("sections", lengths, bound, f"They are {together:g} mm long.")
        return self
