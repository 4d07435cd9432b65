"""Bodies of answers: problems, offers, lists of databases, reports and gear units."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field

from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.named import Named
from service.schemas.ogc import Link


class FaultBody(BaseModel):
    """One thing wrong with the input."""

    field: str = Field(examples=["pair.pinion.bore_diameter_mm"])
    value: Any = Field(examples=[95.0])
    bound: str = Field(examples=["from 4 to 66.9"])
    suggestion: str = Field(examples=["Make the bore smaller."])


class ProblemBody(BaseModel):
    """Problem details."""

    type: str = Field(examples=["urn:lineofaction:problem:bad-input"])
    title: str = Field(examples=["The input cannot be used"])
    status: int = Field(examples=[422])
    detail: str
    errors: list[FaultBody]
    reference: str | None = Field(
        default=None, description="Number of the log entry of an unexpected failure"
    )


class EffectBody(BaseModel):
    """The declaration of an effect."""

    name: str
    needs: list[str]
    adds: list[str]
    cost: str
    sources: list[str]
    valid_for: str


class ExampleBody(BaseModel):
    """A case to begin with."""

    name: str
    title: str
    note: str
    case: Annotated[dict[str, Any], Named("Case")]
    hash: str = Field(description="Hash of its database, whether it is stored or not")


class DatabaseEntry(BaseModel):
    """One database."""

    hash: str = Field(description="Content hash of the input, the name of the resource")
    href: str = Field(description="Its path on the service")
    created: str = Field(description="Time of storage, RFC 3339, UTC")
    size: int = Field(ge=0, description="Size of the file in bytes")
    case: Annotated[dict[str, Any], Named("Case")] | None = Field(
        description="The case with all defaults; null if the file is damaged"
    )


class DatabaseList(BaseModel):
    """A page of databases, the newest first."""

    databases: list[DatabaseEntry]
    links: list[Link]


class ReportTable(BaseModel):
    """A table, its cells as they are read."""

    caption: str
    head: list[str]
    rows: list[list[str]]


class ReportPlot(BaseModel):
    """What ``Plotly.newPlot`` takes."""

    data: list[dict[str, Any]] = Field(description="Traces of plotly.js")
    layout: dict[str, Any] = Field(description="Layout of plotly.js")


class ReportTrack(BaseModel):
    """A sound of a plot."""

    name: str
    query: dict[str, str] = Field(description="Query of /v1/results/{hash}/sound")
    time: list[float] = Field(description="s from its start")
    along: list[float] = Field(description="Where it then is on the horizontal axis")


class ReportSound(BaseModel):
    """What a plot shows, to listen to."""

    caption: str
    tracks: list[ReportTrack]


class ReportFigure(BaseModel):
    """A plot, with what stands in for it where it cannot be seen."""

    key: str
    title: str
    caption: str
    alternative: str = Field(description="The plot in words")
    plot: ReportPlot
    table: ReportTable | None = Field(description="Its numbers; null: none")
    sound: ReportSound | None = Field(None, description="The plot to listen to; null: it has no sound")


class ReportSection(BaseModel):
    """A part with its figures and tables."""

    title: str
    part: Literal["results", "effects", "accuracy", "input", "receipt"] = Field(
        description="Results, or how they were made"
    )
    text: str
    figures: list[ReportFigure]
    tables: list[ReportTable]
    folded: list[ReportTable] = Field(description="Tables that are shown on request")


class ReportBody(BaseModel):
    """A report: main results, and sections with figures and tables."""

    title: str
    lead: str
    alarms: list[str]
    headlines: list[dict[str, str]]
    sections: list[Annotated[dict[str, Any], Named("ReportSection")]]


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
