"""The solid of a housing of a scene: its material, bearing seats, feet and points."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, Strict, model_validator

from dynamics.solid_housing import MATERIALS, Material, SeatWall
from lineofaction.gearbox.schemas.declared import declared_in, figures, with_fields
from lineofaction.gearbox.schemas.model import BoundaryModel, refuse
from lineofaction.gearbox.schemas.rules import given, stated
from lineofaction.gearbox.schemas.scene_types import Name, Point

Direction = Annotated[
    tuple[Annotated[float, Field(ge=-1.0, le=1.0)], ...], Strict(False), Field(min_length=3, max_length=3)
]
Rates = Annotated[
    tuple[Annotated[float, Field(ge=0.0, le=1e15)], ...], Strict(False), Field(min_length=3, max_length=3)
]


def material_by_name(value: object) -> object:
    """Return the figures of a material that is given by its name."""
    if isinstance(value, str) and value in MATERIALS:
        material = MATERIALS[value]
        return {figure.field: figure.own(getattr(material, figure.name)) for figure in figures(Material)}
    return value


@with_fields(declared_in(Material))
class HousingMaterialInput(BoundaryModel):
    """Linear elastic, isotropic material with its density."""


@with_fields(declared_in(SeatWall))
class HousingSeatInput(BoundaryModel):
    """A bearing seat: a bore about the axis of its bearing, its middle where the bearing is."""

    bearing: Name = Field(description="The bushing or rolling bearing in it", examples=["input left"])
    bore_diameter_mm: float
    bore_length_mm: float
    ring: str


class HousingFootInput(BoundaryModel):
    """A face of the housing that stays plane: fixed, or on a mount."""

    model_config = ConfigDict(
        json_schema_extra=stated(
            {"anyOf": [given("point_mm", "normal"), given("low_mm", "high_mm"), given("group")]}
        )
    )

    name: Name = Field(description="Name of the foot", examples=["base"])
    point_mm: Point | None = Field(
        default=None,
        description="A point of the plane that its face is in, x, y, z in the scene, mm",
        examples=[[0.0, -120.0, 0.0]],
    )
    normal: Direction | None = Field(
        default=None, description="Outward normal of this plane, x, y, z", examples=[[0.0, -1.0, 0.0]]
    )
    low_mm: Point | None = Field(
        default=None,
        description="Low corner of a box that the face is in, mm",
        examples=[[-50.0, -121.0, 0.0]],
    )
    high_mm: Point | None = Field(
        default=None, description="High corner of this box, mm", examples=[[0.0, -119.0, 40.0]]
    )
    group: str | None = Field(
        default=None,
        min_length=1,
        max_length=200,
        description="A physical group or node set of a mesh file instead",
        examples=["feet"],
    )
    mount_stiffness_n_per_m: Rates | None = Field(
        default=None,
        description="Stiffness of its mount along x, y, z in N/m; left out: fixed",
        examples=[[2e7, 5e7, 2e7]],
    )
    mount_damping_n_s_per_m: Rates | None = Field(
        default=None,
        description="Damping of its mount along x, y, z in N s/m; left out: none",
        examples=[[2e3, 5e3, 2e3]],
    )

    @model_validator(mode="after")
    def _one_face(self) -> Self:
        """Refuse a face that nothing or too much describes, and damping without a mount."""
        for first, second in (("point_mm", "normal"), ("low_mm", "high_mm")):
            if (getattr(self, first) is None) != (getattr(self, second) is None):
                missing = first if getattr(self, first) is None else second
                refuse(missing, None, f"given with {second if missing == first else first}")
        if self.normal is not None and not any(self.normal):
            refuse("normal", list(self.normal), "a direction: not all zero")
        if (self.group is None) == (self.point_mm is None and self.low_mm is None):
            bound = "given, with normal, or low_mm with high_mm, or both; or group instead"
            refuse("point_mm", self.point_mm, bound, "For example a point of the underside.")
        if self.mount_damping_n_s_per_m is not None and self.mount_stiffness_n_per_m is None:
            refuse("mount_stiffness_n_per_m", None, "given with mount_damping_n_s_per_m")
        return self


class HousingPointInput(BoundaryModel):
    """A named point of a housing whose motion is of interest."""

    name: Name = Field(description="Name of the point", examples=["cover"])
    position_mm: Point = Field(
        description="Where it is, x, y, z in the scene, mm", examples=[[40.0, 120.0, 50.0]]
    )
