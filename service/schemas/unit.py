"""A gear unit of another tool: the file, and what it is here."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, Field

from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.named import Named


class UnitFile(BoundaryModel):
    """A file of REXS, the exchange format of gear-unit tools."""

    rexs_base64: str = Field(
        min_length=4,
        max_length=85_400_000,
        description="The bytes of the file in base64: XML, JSON or ZIP",
        examples=["PG1vZGVsIHZlcnNpb249IjEuNyI+"],
    )
    assume: Annotated[list[Annotated[str, Field(max_length=10_000)]], Field(max_length=1000)] = Field(
        default=[],
        description="Values over the file's before it is opened, in its units: COMPONENT.ATTRIBUTE=VALUE",
        examples=[["14.helix_angle_reference_diameter=-12"]],
    )


class StageBody(BaseModel):
    """A cylindrical stage and its case."""

    name: str
    stage: int = Field(description="Id of the stage in the file")
    equal: list[int] = Field(description="Ids of stages with the same case: those of the other planets")
    case: Annotated[dict[str, Any], Named("Case")]


class CaseForceBody(BaseModel):
    """A force of the scene that differs under a load case."""

    name: str
    force_n: list[float] = Field(description="In x, y, z")
    moment_n_m: list[float] = Field(description="About x, y, +z")


class LoadCaseBody(BaseModel):
    """A load case of the scene."""

    name: str
    share: float = Field(description="Of the time, 0 to 1")
    torque_n_m: float = Field(description="On the shaft of the scene's first drive")
    speed_rpm: float = Field(description="Of that shaft")
    direction: str = Field(description="Flanks that carry: drive, as in the scene, or coast")
    forces: list[CaseForceBody] = Field(description="Forces that are not as in the scene")


class UnitLine(BaseModel):
    """What became of a component or of a value."""

    place: str
    component: int
    kind: str
    name: str
    item: str = Field(description="The attribute; empty for the component itself")
    fate: str = Field(description="taken, assumed, derived, defaulted, ignored or refused")
    words: str
    line: int | None = Field(description="Of the component in an XML file, from 1; null in other forms")


class UnitBody(BaseModel):
    """Cases, scene and load cases of a gear unit, and the account of the import."""

    left_out: list[str] = Field(
        description="What the file has and the scene has not, a sentence a reason; the scene repeats it"
    )
    cases: list[StageBody]
    scene: Annotated[dict[str, Any], Named("SceneInput")] | None = Field(
        description="The whole unit, the cases of its meshes written out; null: the account says why"
    )
    load_cases: list[LoadCaseBody]
    lines: list[UnitLine]
    summary: list[str] = Field(
        description="What was refused, assumed, defaulted and derived, a sentence each"
    )
