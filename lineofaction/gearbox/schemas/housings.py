"""Housings of a scene: matrices over their bearings, the file of their solid, or measured responses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, ConfigDict, Field, model_validator

from dynamics.joints.housing import Housing
from dynamics.solid_housing import ReductionSettings
from lineofaction.gearbox.schemas.declared import declared_in, figures, with_fields
from lineofaction.gearbox.schemas.file_content import FileContentInput
from lineofaction.gearbox.schemas.housing_solid import (
    MATERIAL,
    PERPENDICULAR,
    Direction,
    HousingFootInput,
    HousingMaterialInput,
    HousingSeatInput,
    PointNodeInput,
    SeatNodeInput,
    material_by_name,
)
from lineofaction.gearbox.schemas.model import BoundaryModel, HousingRows, Listed, Name, Point, refuse
from lineofaction.gearbox.schemas.rules import all_of, exactly_one_of

SOURCES = ("step_file", "mesh_file")
"""Fields that name the file of a solid."""
RESPONSES = "frf_file"
"""The field that names the file of measured responses."""
_MATRICES = ("stiffness_matrix", "damping_matrix", "mass_matrix", "seat_positions_mm", "modal_coordinates")
_SOLID = ("material", "seats", "feet")
_AXES = ("x_axis", "z_axis")
_OF_SOLID = (
    *(*_SOLID, "points", "modal_damping", "mesh_unit", "origin_mm"),
    *(figure.field for figure in figures(ReductionSettings)),
)
_NODES = ("seat_nodes", "point_nodes")
_BY_MATRICES, _BY_SOLID = "stiffness_matrix", "step_file or mesh_file"
_FOREIGN = {
    _BY_MATRICES: {_BY_SOLID: (*_OF_SOLID, *_AXES), RESPONSES: _NODES},
    _BY_SOLID: {_BY_MATRICES: _MATRICES, RESPONSES: _NODES},
    RESPONSES: {_BY_MATRICES: _MATRICES, _BY_SOLID: _OF_SOLID},
}
"""Fields that a housing must leave out, by the kind of housing and by the kind that the fields belong to."""


def _is_absent(value: object) -> bool:
    """Whether a field that came after results had been stored is not there."""
    return value is None or value == ()


@with_fields(declared_in(Housing))
class _MatrixHousing(BoundaryModel):
    """The fields of a housing by its matrices."""

    damping_ratio: float
    name: Name = Field(description="Name of the housing", examples=["gearbox"])
    bushings: Listed[Name] = Field(
        default=(),
        max_length=1000,
        description="Bushings and rolling bearings in the order of the matrix; in a scene file with "
        "modes_file, and with seats, by default those of the seats",
        examples=[["a", "b"]],
    )
    stiffness_matrix: HousingRows | None = Field(
        default=None,
        description="Stiffness over all seats: per bushing 3 rows x, y, z, or 5 with tilt_x, tilt_y, or 6 "
        "with the rotation; then a row per modal coordinate; N, m, rad. A scene file may name a CSV or NPZ "
        "file by stiffness_file instead, or a reduced housing (NetCDF) by modes_file",
    )
    damping_matrix: HousingRows | None = Field(
        default=None,
        description="Damping over all seats, likewise; left out: none, with mass that of damping_ratio",
    )
    mass_matrix: HousingRows | None = Field(
        default=None,
        description="Mass over all seats, likewise; kg, m, rad; left out: no mass",
        exclude_if=_is_absent,
    )
    seat_positions_mm: Listed[Point] | None = Field(
        default=None,
        min_length=1,
        max_length=1000,
        description="Positions of the seats in the fixed frame, x, y, z in mm; checked against the bearings",
        exclude_if=_is_absent,
    )


@with_fields(declared_in(ReductionSettings))
class HousingInput(_MatrixHousing):
    """An elastic housing that several bearings share: by matrices, or by its solid, which is reduced.

    Or one that was measured, from the seats of bearings to points: it vibrates and does not act back.
    """

    class HousingPointInput(BoundaryModel):
        """A named point of a housing whose motion is of interest."""

        name: Name = Field(description="Name of the point", examples=["cover"])
        position_mm: Point = Field(
            description="Position of the point in the scene, x, y, z in mm", examples=[[40.0, 120.0, 50.0]]
        )

    model_config = ConfigDict(
        json_schema_extra=all_of(exactly_one_of("stiffness_matrix", *SOURCES, RESPONSES))
    )

    modes: int
    element_size_mm: float | None
    loss_factor: float | None
    modal_damping: Listed[Annotated[float, Field(ge=0.0, le=1.0)]] = Field(
        default=(),
        max_length=2000,
        description="Measured damping ratios of the modes of the solid in rising order, in place of "
        "loss_factor and damping_ratio; the last holds for all that follow",
        examples=[[0.006, 0.004, 0.008]],
        exclude_if=_is_absent,
    )
    modes_file: str | None = Field(
        default=None,
        max_length=1000,
        description="File of the reduced housing that has the matrices, on the disk of who wrote the scene",
        examples=["case.nc"],
        exclude_if=_is_absent,
    )
    step_file: FileContentInput | None = Field(
        default=None,
        description="STEP file of its solid; a scene file has the name of the file",
        examples=[{"name": "case.step", "content": "eJwDAAAAAAE="}],
        exclude_if=_is_absent,
    )
    mesh_file: FileContentInput | None = Field(
        default=None,
        description="Mesh of its solid in tetrahedra: gmsh, Abaqus, Nastran, VTK; a scene file has the name "
        "of the file",
        examples=[{"name": "case.inp", "content": "eJwDAAAAAAE="}],
        exclude_if=_is_absent,
    )
    mesh_unit: Literal["mm", "m"] | None = Field(
        default=None,
        description="Unit of the coordinates in mesh_file, which does not say it",
        examples=["mm"],
        exclude_if=_is_absent,
    )
    material: Annotated[HousingMaterialInput, BeforeValidator(material_by_name, MATERIAL)] | None = Field(
        default=None,
        description="Material of the solid: gray_cast_iron, spheroidal_cast_iron, cast_aluminum, or a table",
        examples=["gray_cast_iron"],
        exclude_if=_is_absent,
    )
    seats: Listed[HousingSeatInput] = Field(
        default=(), max_length=100, description="Bearing seats of the solid", exclude_if=_is_absent
    )
    feet: Listed[HousingFootInput] = Field(
        default=(), max_length=100, description="Faces that hold the solid", exclude_if=_is_absent
    )
    points: Listed[HousingPointInput] = Field(
        default=(), max_length=1000, description="Points of interest of the solid", exclude_if=_is_absent
    )
    frf_file: FileContentInput | None = Field(
        default=None,
        description="Universal file (dataset 58) of measured frequency responses from bearing seats to "
        "points; a scene file has the name of the file",
        examples=[{"name": "gearcase.uff", "content": "eJwDAAAAAAE="}],
        exclude_if=_is_absent,
    )
    seat_nodes: Listed[SeatNodeInput] = Field(
        default=(),
        max_length=1000,
        description="Bearings by the reference nodes of frf_file",
        exclude_if=_is_absent,
    )
    point_nodes: Listed[PointNodeInput] = Field(
        default=(),
        max_length=1000,
        description="Points by the response nodes of frf_file",
        exclude_if=_is_absent,
    )
    origin_mm: Point | None = Field(
        default=None,
        description="Position of the file's origin in the scene, x, y, z in mm; left out: at the scene's "
        "origin",
        examples=[[0.0, 0.0, 60.0]],
        exclude_if=_is_absent,
    )
    x_axis: Direction | None = Field(
        default=None,
        description="Direction of the x axis of the file in the scene; left out: x",
        examples=[[1.0, 0.0, 0.0]],
        exclude_if=_is_absent,
    )
    z_axis: Direction | None = Field(
        default=None,
        description="Direction of the z axis of the file in the scene; left out: z",
        examples=[[0.0, 1.0, 0.0]],
        exclude_if=_is_absent,
    )

    @property
    def is_solid(self) -> bool:
        """Whether it is given by the file of its solid."""
        return any(getattr(self, name) is not None for name in SOURCES)

    @property
    def is_measured(self) -> bool:
        """Whether it is given by measured responses, which move it and no shaft."""
        return self.frf_file is not None

    @property
    def has_surface(self) -> bool:
        """Whether the housing's file may have a surface; matrices alone have none."""
        return self.is_solid or self.modes_file is not None

    @property
    def file_x_axis(self) -> tuple[float, ...]:
        """Direction of the x axis of the file in the scene."""
        return self.x_axis or (1.0, 0.0, 0.0)

    @property
    def file_z_axis(self) -> tuple[float, ...]:
        """Direction of the z axis of the file in the scene."""
        return self.z_axis or (0.0, 0.0, 1.0)

    @model_validator(mode="before")
    @classmethod
    def _bearings_of_seats(cls, data: Any) -> Any:
        """Fill in the bearings of the seats, so that the echo has them."""
        if not isinstance(data, dict) or data.get("bushings"):
            return data
        seats, nodes = data.get("seats"), data.get("seat_nodes")
        listed = seats or nodes
        if not isinstance(listed, list | tuple) or not listed:
            return data
        names = [_bearing(seat) for seat in listed]
        if None in names:
            return data
        return data | {"bushings": names if seats else list(dict.fromkeys(names))}

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        """Refuse missing fields of one kind of housing, and fields that belong to another."""
        all_sources = ("stiffness_matrix", *SOURCES, RESPONSES)
        sources = [name for name in all_sources if getattr(self, name) is not None]
        if len(sources) != 1:
            others = "step_file, mesh_file, stiffness_file, modes_file or frf_file"
            bound = f"given, or {others} instead, one of them"
            refuse("stiffness_matrix", sources or None, bound, "See docs/case-file.md.")
        for kind, fields in _FOREIGN[self._kind].items():
            for name in fields:
                if name in self.model_fields_set and getattr(self, name) not in (None, ()):
                    refuse(name, "given", f"left out, or given with {kind}")
        if self.is_solid:
            self._check_solid()
        elif self.is_measured:
            self._check_measured()
        elif not self.bushings:
            refuse("bushings", [], "a list of at least 1", "The bearings in the order of the matrix.")
        return self

    @property
    def _kind(self) -> str:
        if self.is_measured:
            return RESPONSES
        return _BY_SOLID if self.is_solid else _BY_MATRICES

    def _check_measured(self) -> None:
        remedy = {
            "seat_nodes": 'For example [{bearing = "input left", node = 1}].',
            "point_nodes": 'For example [{name = "cover", node = 11}].',
        }
        for name in _NODES:
            nodes = [part.node for part in getattr(self, name)]
            if not nodes:
                refuse(name, None, "given with frf_file", remedy[name])
            for index in _repeated(nodes):
                refuse(f"{name}[{index}].node", nodes[index], "a node that no other one of them has")
        if self.bushings != tuple(dict.fromkeys(part.bearing for part in self.seat_nodes)):
            bound = "left out with seat_nodes"
            refuse("bushings", list(self.bushings), bound, "The nodes of seats name their bearings.")
        if self.damping_ratio != type(self).model_fields["damping_ratio"].default:
            bound = "left out with frf_file"
            refuse("damping_ratio", self.damping_ratio, bound, "The responses hold the damping.")
        self._check_axes()

    def _check_solid(self) -> None:
        remedy = {
            "material": 'For example "gray_cast_iron".',
            "seats": 'For example [{bearing = "input left", bore_diameter_mm = 62, bore_length_mm = 18}].',
            "feet": "A housing of a scene is held: name its underside, or mounts.",
        }
        for name in _SOLID:
            if not getattr(self, name):
                refuse(name, None, "given with step_file or mesh_file", remedy[name])
        if self.modal_damping and self.loss_factor is not None:
            bound = "left out with loss_factor"
            refuse("modal_damping", list(self.modal_damping), bound, "State one of them.")
        if self.bushings != tuple(seat.bearing for seat in self.seats):
            refuse("bushings", list(self.bushings), "left out with seats", "Seats name their bearings.")
        if (self.mesh_unit is None) == (self.mesh_file is not None):
            bound = "given with mesh_file" if self.mesh_unit is None else "left out with step_file"
            refuse("mesh_unit", self.mesh_unit, bound, 'Unit of its coordinates: "mm" or "m".')
        if self.mesh_file is not None and self.element_size_mm is not None:
            refuse("element_size_mm", self.element_size_mm, "left out with mesh_file")
        self._check_axes()
        for kind in ("feet", "points"):
            names = [part.name for part in getattr(self, kind)]
            for index in _repeated(names):
                refuse(f"{kind}[{index}].name", names[index], "a name that no other one of them has")

    def _check_axes(self) -> None:
        for axis in _AXES:
            if getattr(self, axis) is not None and not any(getattr(self, axis)):
                refuse(axis, list(getattr(self, axis)), "a direction: not all zero")
        across = sum(x * z for x, z in zip(self.file_x_axis, self.file_z_axis, strict=True))
        if abs(across) > PERPENDICULAR * math.hypot(*self.file_x_axis) * math.hypot(*self.file_z_axis):
            bound = f"perpendicular to z_axis, {list(self.file_z_axis)}"
            refuse("x_axis", list(self.file_x_axis), bound, "Give both where the file is turned.")


def _repeated(values: Sequence[object]) -> list[int]:
    """Return the indices of the values that are in the list before."""
    return [index for index, value in enumerate(values) if value in values[:index]]


def _bearing(seat: Any) -> str | None:
    """Return the bearing of a table of seats, before it is validated; None without a name."""
    name = seat.get("bearing") if isinstance(seat, dict) else getattr(seat, "bearing", None)
    return name if isinstance(name, str) else None
