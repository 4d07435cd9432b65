"""Gear pairs in mesh of a scene, and where their forces come from."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, model_validator

from dynamics.meshes.gear_mesh import GearMesh
from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.closed_form_meshes import CoastFlankInput, StiffnessMeshInput
from lineofaction.gearbox.schemas.declared import declared_in, with_fields
from lineofaction.gearbox.schemas.model import HASH, BoundaryModel, Name, refuse
from lineofaction.gearbox.schemas.rules import all_of, exactly_one_of

_SOURCES = ("case", "case_file", "database_file", "database_hash", "stiffness")


@with_fields(declared_in(GearMesh, marked=False))
class _TabledMesh(BoundaryModel):
    """Two gears in mesh but for their coast flank."""

    name: Name = Field(description="Name of the mesh", examples=["mesh"])
    driver: Name = Field(
        description="The driving gear: the pinion of the case, with wheel_drives its wheel",
        examples=["pinion"],
    )
    driven: Name = Field(description="The driven gear: the other gear of the case", examples=["wheel"])
    wheel_drives: bool = Field(
        default=False, description="The wheel of the case, a ring gear, drives its pinion", examples=[False]
    )
    case: Case | None = Field(default=None, description="The case, written out")
    case_file: str | None = Field(
        default=None,
        max_length=4096,
        description="A case file, relative to the scene file",
        examples=["pair.toml"],
    )
    database_file: str | None = Field(
        default=None,
        max_length=4096,
        description="An STE database, relative to the scene file",
        examples=["ste.nc"],
    )
    database_hash: Annotated[str, Field(pattern=HASH)] | None = Field(
        default=None, description="Content hash of a database of the service", examples=["0" * 64]
    )
    stiffness: StiffnessMeshInput | None = Field(
        default=None, description="The mesh in closed form: stiffness and transmission error by the position"
    )


class MeshInput(_TabledMesh):
    """Two gears in mesh and the source of their force: an STE database or a closed form."""

    model_config = ConfigDict(json_schema_extra=all_of(exactly_one_of(*_SOURCES)))

    coast_flank: CoastFlankInput | None = Field(
        default=None,
        description="The coast flank; left out: only the driving flank carries force",
        examples=[{"backlash_um": 80.0}],
    )

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        names = [name for name in _SOURCES if getattr(self, name) is not None]
        if len(names) != 1:
            refuse("case", names or None, f"given once, as one of {', '.join(_SOURCES)}", "Keep one of them.")
        return self
