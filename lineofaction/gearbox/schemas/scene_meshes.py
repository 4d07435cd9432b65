"""Gear pairs in mesh of a scene, and where their forces come from."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.model import BoundaryModel, refuse
from lineofaction.gearbox.schemas.result_kinds import HASH
from lineofaction.gearbox.schemas.rules import exactly_one_of, stated
from lineofaction.gearbox.schemas.scene_stiffness import StiffnessMeshInput
from lineofaction.gearbox.schemas.scene_types import Name

_SOURCES = ("case", "case_file", "database_file", "database_hash", "stiffness")


class CoastFlankInput(BoundaryModel):
    """The backs of a mesh's teeth, alike to their fronts, for the effect "backlash"."""

    backlash_um: float = Field(
        ge=0.0, le=1e5, description="Backlash along the transverse line of action in um", examples=[80.0]
    )
    tooth_thickness: float | None = Field(
        default=None,
        gt=0.0,
        lt=1.0,
        description="Thickness of the driver's teeth over the pitch, both on the operating pitch circle; "
        "left out: both gears' teeth are equally thick",
        examples=[0.49],
    )


class MeshInput(BoundaryModel):
    """Two gears in mesh and the source of their force: an STE database or a closed form."""

    model_config = ConfigDict(json_schema_extra=stated(exactly_one_of(*_SOURCES)))

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
    technique: Literal["constant_torque", "variable_torque"] = Field(
        default="variable_torque", description="Technique of the mesh force", examples=["variable_torque"]
    )
    damping_n_s_per_m: float | None = Field(
        default=None,
        ge=0.0,
        le=1e12,
        description="Mesh damping in N s/m; left out: from damping_ratio",
        examples=[1e3],
    )
    damping_ratio: float = Field(
        default=0.05, ge=0.0, le=10.0, description="Damping ratio of the mesh", examples=[0.05]
    )
    nominal_force_n: float | None = Field(
        default=None,
        gt=0.0,
        le=1e9,
        description="Nominal transverse mesh force in N; left out: from the loads",
        examples=[2660.0],
    )
    position_offset: float = Field(
        default=0.0, ge=-1e6, le=1e6, description="Position in base pitches at the start", examples=[0.0]
    )
    misalignment_um: float = Field(
        default=0.0, ge=-1e4, le=1e4, description="Misalignment in um", examples=[0.0]
    )
    center_distance_change_mm: float = Field(
        default=0.0, ge=-100.0, le=100.0, description="Change of the center distance in mm", examples=[0.0]
    )
    friction: float | None = Field(
        default=None,
        gt=0.0,
        le=1.0,
        description="Coefficient of sliding friction of the teeth; left out: none",
        examples=[0.05],
    )
    coast_flank: CoastFlankInput | None = Field(
        default=None,
        description="The coast flank; left out: only the driving flank carries force",
        examples=[{"backlash_um": 80.0}],
    )

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        """Exactly one source of the table."""
        names = [name for name in _SOURCES if getattr(self, name) is not None]
        if len(names) != 1:
            refuse("case", names or None, f"given once, as one of {', '.join(_SOURCES)}", "Keep one of them.")
        return self
