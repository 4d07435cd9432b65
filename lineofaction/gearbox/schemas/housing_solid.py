"""The solid of a housing of a scene: its material, bearing seats, feet and points."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, ConfigDict, Field, model_validator

from dynamics.solid_housing import MATERIALS, Material, SeatWall
from dynamics.temperatures import Temperatures
from lineofaction.gearbox.schemas.declared import declared_in, figures, with_fields
from lineofaction.gearbox.schemas.model import BoundaryModel, Listed, Name, Point, refuse
from lineofaction.gearbox.schemas.rules import all_of, required

_THREE = Field(min_length=3, max_length=3)
Direction = Annotated[Listed[Annotated[float, Field(ge=-1.0, le=1.0)]], _THREE]
Node = Annotated[int, Field(ge=0, le=2**31 - 1)]
Rates = Annotated[Listed[Annotated[float, Field(ge=0.0, le=1e15)]], _THREE]
PERPENDICULAR = 1e-6
"""Largest cosine of the angle between two axes that count as perpendicular."""


@with_fields(declared_in(Material))
class HousingMaterialInput(BoundaryModel):
    """Linear elastic, isotropic material with its density."""


def material_by_name(value: object) -> object:
    """Return the figures of a material by name; any other value comes back as it is.

    Figures that were added after results had been stored are left out, so that a scene without them keeps
    the address of its result.
    """
    return _figures_of(value, complete=False)


def _figures_of(value: object, *, complete: bool) -> object:
    """Return the figures of a material by name; without `complete` only those always written."""
    if not isinstance(value, str) or value not in MATERIALS:
        return value
    material = MATERIALS[value]
    declared = [figure for figure in figures(Material) if complete or not figure.what.omit_default]
    return {figure.field: figure.boundary_value(getattr(material, figure.name)) for figure in declared}


MATERIAL: Any = Literal[tuple(MATERIALS)] | HousingMaterialInput
"""Type of a material in a scene: the name of a known material, or a table."""


@with_fields(declared_in(Temperatures))
class TemperaturesInput(BoundaryModel):
    """Steady temperature of the housing; shafts, gears and rings of rolling bearings then state theirs."""

    housing_material: Annotated[
        HousingMaterialInput, BeforeValidator(lambda value: _figures_of(value, complete=True), MATERIAL)
    ] = Field(
        description="Material of the housing with thermal_expansion_per_k, or the name of a material",
        examples=["cast_aluminum"],
    )


@with_fields(declared_in(SeatWall))
class HousingSeatInput(BoundaryModel):
    """A bearing seat: a bore about the axis of its bearing, its middle where the bearing is."""

    bearing: Name = Field(description="The bushing or rolling bearing in it", examples=["input left"])
    bore_diameter_mm: float
    bore_length_mm: float
    ring: str


class SeatNodeInput(BoundaryModel):
    """A reference node of measured responses: node and direction in which a bearing's seat was excited."""

    bearing: Name = Field(description="The bushing or rolling bearing in the seat", examples=["input left"])
    node: Node = Field(description="Reference node of the seat in the file", examples=[1])


class PointNodeInput(BoundaryModel):
    """A response node of measured responses: where the motion was measured."""

    name: Name = Field(description="Name of the point", examples=["cover"])
    node: Node = Field(description="Response node of the point in the file", examples=[11])


class HousingFootInput(BoundaryModel):
    """A face of the housing that stays plane: fixed, or on a mount."""

    model_config = ConfigDict(
        json_schema_extra=all_of(
            {"anyOf": [required("point_mm", "normal"), required("low_mm", "high_mm"), required("group")]}
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
