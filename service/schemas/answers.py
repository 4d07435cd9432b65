"""Bodies of answers: OGC API - Processes 1.0 (OGC 18-062r2), problems, offers, reports and gear units."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, create_model

from lineofaction.gearbox.schemas.figures import Headline
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.named_parts import Named

Uri = Annotated[str, Field(max_length=2000, examples=["https://hooks.example.com/loa?case=12"])]
JobStatus = Literal["accepted", "running", "successful", "failed", "dismissed"]
CONFORMANCE = (
    "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/core",
    "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/ogc-process-description",
    "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/json",
    "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/job-list",
    "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/dismiss",
)
Value = bool | int | float | str | list[bool | int | float | str | None] | None


class Subscriber(BoundaryModel):
    """Addresses that are called about a job; the service lists the origins that it calls."""

    successUri: Uri | None = Field(None, description="Gets the document of the results")  # noqa: N815
    failedUri: Uri | None = Field(None, description="Gets the problem of a job without result")  # noqa: N815
    inProgressUri: Uri | None = Field(None, description="Gets the status of a job that runs")  # noqa: N815

    @property
    def uris(self) -> dict[str, str]:
        """Addresses by event."""
        named = {"inProgress": self.inProgressUri, "success": self.successUri, "failed": self.failedUri}
        return {event: uri for event, uri in named.items() if uri is not None}


class WebhookState(BaseModel):
    """State of a call about an event of a job."""

    event: Literal["inProgress", "success", "failed"]
    state: Literal["waiting", "delivered", "skipped", "given up"]
    attempts: int = Field(ge=0)
    message: str = Field(description="Message of the last attempt")


class Link(BaseModel):
    """A link of RFC 8288."""

    href: str
    rel: str
    type: str = "application/json"
    title: str = ""


class Landing(BaseModel):
    """The landing page of the service, with links to its parts."""

    title: str
    description: str
    version: str
    links: list[Link]


class Conformance(BaseModel):
    """The conformance classes of the service."""

    conformsTo: list[str]  # noqa: N815 (name of the standard)


class Parameter(BaseModel):
    """A parameter of a process that the standard does not know."""

    name: str
    value: list[Any]


class AdditionalParameters(BaseModel):
    """Data from which a page offers a study; empty for other processes.

    Members are ``action`` (the words of a button), ``subjects`` (names of the inputs that hold a case or a
    scene) and ``fields`` (schemas of the inputs with a title, by name).
    """

    title: Literal["Card"] = "Card"
    parameters: list[Parameter]


class ProcessSummary(BaseModel):
    """The description of a process."""

    id: str
    title: str
    description: str
    version: str
    jobControlOptions: list[str]  # noqa: N815
    outputTransmission: list[str]  # noqa: N815
    links: list[Link]
    additionalParameters: AdditionalParameters  # noqa: N815


class ProcessList(BaseModel):
    """The list of all processes of the service."""

    processes: list[ProcessSummary]
    links: list[Link]


class ValueDescription(BaseModel):
    """An input or an output of a process."""

    title: str
    description: str
    schema_: dict[str, Any] = Field(alias="schema", description="JSON Schema of the value")


class ProcessDescription(ProcessSummary):
    """A process with the schemas of its inputs and outputs."""

    inputs: dict[str, ValueDescription]
    outputs: dict[str, ValueDescription]


class Difference(BaseModel):
    """An input that differs from the job before, or from its default."""

    field: str = Field(description="Path of the input", examples=["case.load.torque_n_m"])
    before: Value = Field(description="Value before; null: not stated; of a long list its length")
    value: Value = Field(description="Value of this job; null: not stated; of a long list its length")


class Differences(BaseModel):
    """The inputs in which a job differs from its caller's job before it of the same process."""

    since: str | None = Field(description="The job before it; null: none, it is compared with the defaults")
    first: list[Difference] = Field(description="The first of them, at most 12")
    number: int = Field(ge=0, description="Number of all of them")


class StatusInfo(BaseModel):
    """The state of a job."""

    model_config = ConfigDict(extra="forbid")

    processID: str  # noqa: N815
    type: Literal["process"] = "process"
    jobID: str  # noqa: N815
    status: JobStatus
    title: str = Field(default="", description="Name that the caller gave the job")
    tags: list[str] = Field(default=[], description="Tags that the caller gave the job")
    priority: int = Field(
        default=0, description="Priority of the computation, the highest of the jobs that share it"
    )
    max_cost_s: float | None = Field(
        default=None, description="CPU seconds after which the computation is ended; null: no limit"
    )
    subject: str = Field(default="", description="Subject of the job in words: the pair, or the scene")
    differences: Differences | None = Field(
        default=None, description="Inputs that differ from the caller's job before, or from the defaults"
    )
    message: str = Field(description="State of the job in words")
    created: str = Field(description="RFC 3339, UTC")
    started: str | None = None
    finished: str | None = None
    updated: str
    progress: int = Field(ge=0, le=100, description="Per cent of the whole job")
    remaining_s: float | None = Field(
        default=None, description="Seconds that a running job still needs, by its pace; null: not known yet"
    )
    ahead: int | None = Field(
        default=None,
        ge=0,
        description="Computations before a waiting job, running ones too; null: it does not wait",
    )
    stage: str = Field(description="The stage the job is in")
    stage_progress: int = Field(ge=0, le=100, description="Per cent of the stage")
    attempts: int = Field(ge=0, description="Number of starts of the computation")
    parentID: str | None = Field(  # noqa: N815
        default=None, description="The batch that the job is in; null: none"
    )
    place: int = Field(default=0, ge=0, description="Place in the batch, from 0")
    children: int = Field(default=0, ge=0, description="Number of jobs of a batch; 0: this is none")
    warnings: list[Annotated[dict[str, Any], Named("InputWarning")]] | None = Field(
        default=None,
        description="Implausible inputs: check, field, value, unit, message; null in lists",
    )
    headline: Headline | None = Field(
        default=None,
        description="Headline of the result; null: no result, or a large one of an older version",
    )
    webhooks: list[WebhookState] | None = Field(
        default=None, description="Calls about the job; null in lists and events"
    )
    links: list[Link]


class JobInputs(BaseModel):
    """The inputs of a job: its process is executed with them again."""

    processID: str  # noqa: N815
    inputs: dict[str, Any] = Field(description="Inputs by name, as in an execution")


class JobList(BaseModel):
    """A page of jobs, the newest first."""

    jobs: list[StatusInfo]
    links: list[Link]


class ResultReference(BaseModel):
    """The address of a result."""

    href: str
    type: str
    hash: str = Field(description="Content hash of the input, the name of the resource")


class ResultFigures(BaseModel):
    """Figures of a result; the figures of its kind are further members."""

    model_config = ConfigDict(extra="allow")

    hash: str = Field(description="Content hash of the input, the name of the resource")
    sha256: str = Field(description="Digest of the file")
    size: int = Field(ge=0, description="Bytes of the file")


def results_document(process: str, output: str) -> type[BaseModel]:
    """Return the model of the results of a process as a document: its one output, by name."""
    closed = ConfigDict(extra="forbid")
    fields: dict[str, Any] = {output: (ResultReference, Field(description="The netCDF file"))}
    doc = f"Where the result of the process {process} is."
    return create_model(f"{class_name(process)}Results", __config__=closed, __doc__=doc, **fields)


def class_name(process: str) -> str:
    """Return the beginning of the model names of a process."""
    return process.title().replace("-", "")


class FaultBody(BaseModel):
    """A fault of the input."""

    field: str = Field(examples=["pair.pinion.bore_diameter_mm"])
    value: Any = Field(examples=[95.0])
    bound: str = Field(examples=["from 4 to 66.9"])
    suggestion: str = Field(examples=["Make the bore smaller."])


class ProblemBody(BaseModel):
    """Problem details by RFC 9457, with the faults of the input."""

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
    stored: bool = Field(description="Whether its database is stored")


class DatabaseEntry(BaseModel):
    """A database in the list."""

    hash: str = Field(description="Content hash of the input, the name of the resource")
    href: str = Field(description="Path of the database on the service")
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
    """Arguments of ``Plotly.newPlot``."""

    data: list[dict[str, Any]] = Field(description="Traces of plotly.js")
    layout: dict[str, Any] = Field(description="Layout of plotly.js")


class ReportTrack(BaseModel):
    """A sound of a plot."""

    name: str
    query: dict[str, str] = Field(description="Query of /v1/results/{hash}/sound")
    time: list[float] = Field(description="Times from the start of the sound, s")
    along: list[float] = Field(description="Value on the horizontal axis at each time")
    mesh_hz: list[float] | None = Field(
        None, description="Frequency of mesh order 1 at each time, Hz; null: no mesh"
    )


class ReportSound(BaseModel):
    """Sound of a plot."""

    caption: str
    tracks: list[ReportTrack]


class ReportFigure(BaseModel):
    """A plot, with a text and a table for readers who cannot see it."""

    key: str
    title: str
    caption: str
    alternative: str = Field(description="The plot in words")
    plot: ReportPlot
    table: ReportTable | None = Field(description="Numbers of the plot as a table; null: none")
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


class ShaftMotion(BaseModel):
    """Complex amplitudes of a shaft at stations evenly spaced along its axis."""

    name: str
    position_mm: list[float] = Field(description="Positions of the first and the last station")
    real: list[list[float]] = Field(
        description="Motion at phase 0, by station: x, y, z in mm, tilt about x, tilt about y, rotation in "
        "rad"
    )
    imaginary: list[list[float]] = Field(description="A quarter of a period before")


class HousingSurface(BaseModel):
    """A housing's surface; 32-bit numbers, little-endian, in Base64, node by node."""

    place_mm: str = Field(description="x, y, z of each node")
    normal: str = Field(description="Outward, of length 1")
    facets: str = Field(description="Unsigned integers: three nodes each, counter-clockwise from outside")


class SurfaceMotion(HousingSurface):
    """A housing's surface and the complex amplitudes of its motion."""

    real: str = Field(description="Motion at phase 0: x, y, z in mm, mm/s where there are levels")
    imaginary: str = Field(description="A quarter of a period before")
    level_db: str | None = Field(
        description="Level of the normal velocity, root mean square, re 50 nm/s; null: a shape without size"
    )


class MovedUnit(BaseModel):
    """A motion of a unit about where it stands."""

    oscillates: bool = Field(description="Whether its phase runs; a deflection rests")
    shafts: list[ShaftMotion]
    surface: SurfaceMotion | None = Field(
        description="Motion of a housing's surface; null: the result has none"
    )


class MotionGroup(BaseModel):
    """Motions that are listed together, by their names."""

    name: str
    motions: list[str]


class MotionBody(BaseModel):
    """Motions of a unit that a result holds."""

    groups: list[MotionGroup] = Field(
        description="All of them, numbered through from 0",
        examples=[[{"name": "at rest", "motions": ["412 Hz, torsion, damping 2 %"]}]],
    )
    motion: MovedUnit | None = Field(
        description="The one of the number; null without a number", examples=[None]
    )


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
    force_n: list[float] = Field(description="Force along x, y, z")
    moment_n_m: list[float] = Field(description="Moment about x, y, z")


class LoadCaseBody(BaseModel):
    """A load case of the scene."""

    name: str
    share: float = Field(description="Share of the time, 0 to 1")
    torque_n_m: float = Field(description="Torque on the shaft of the scene's first drive")
    speed_rpm: float = Field(description="Speed of the shaft of the scene's first drive")
    direction: str = Field(description="Flanks that carry: drive, as in the scene, or coast")
    forces: list[CaseForceBody] = Field(description="Forces that differ from those of the scene")


class UnitLine(BaseModel):
    """Fate of a component or of a value in an import."""

    place: str
    component: int
    kind: str
    name: str
    item: str = Field(description="The attribute; empty for the component itself")
    fate: str = Field(description="taken, assumed, derived, defaulted, ignored or refused")
    words: str
    line: int | None = Field(description="Line of the component in an XML file, from 1; null in other forms")


class UnitBody(BaseModel):
    """Cases, scene and load cases of a gear unit, and the account of the import."""

    left_out: list[str] = Field(
        description="Parts of the file that the scene lacks, one sentence for each reason, as in the scene"
    )
    cases: list[StageBody]
    scene: Annotated[dict[str, Any], Named("SceneInput")] | None = Field(
        description="The whole unit, the cases of its meshes written out; null: the account says why"
    )
    load_cases: list[LoadCaseBody]
    lines: list[UnitLine]
    summary: list[str] = Field(
        description="Refused, assumed, defaulted and derived values, one sentence each"
    )
