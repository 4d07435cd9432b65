"""Bodies of OGC API - Processes 1.0 (OGC 18-062r2): links, processes, execution, status."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, create_model

from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.named import Named

Uri = Annotated[str, Field(max_length=2000, examples=["https://hooks.example.com/loa?case=12"])]


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
    """What came of a call about a job."""

    event: Literal["inProgress", "success", "failed"]
    state: Literal["waiting", "delivered", "skipped", "given up"]
    attempts: int = Field(ge=0)
    message: str = Field(description="Of the last attempt")


JobStatus = Literal["accepted", "running", "successful", "failed", "dismissed"]

CONFORMANCE = (
    "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/core",
    "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/ogc-process-description",
    "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/json",
    "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/job-list",
    "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/dismiss",
)


Value = bool | int | float | str | list[bool | int | float | str | None] | None


class Link(BaseModel):
    """A link of RFC 8288."""

    href: str
    rel: str
    type: str = "application/json"
    title: str = ""


class Landing(BaseModel):
    """The landing page."""

    title: str
    description: str
    version: str
    links: list[Link]


class Conformance(BaseModel):
    """The conformance classes met."""

    conformsTo: list[str]  # noqa: N815 (name of the standard)


class Parameter(BaseModel):
    """A parameter of a process that the standard does not know."""

    name: str
    value: list[Any]


class AdditionalParameters(BaseModel):
    """What a page needs to offer a study; empty for other processes.

    Its ``action`` (the words of a button), its ``subjects`` (names of the inputs that hold a case or a scene)
    and its ``fields`` (schemas of those inputs that have a title, by name).
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
    """All processes."""

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
    """An input that differs from that of the job before, or from its default."""

    field: str = Field(description="Path of the input", examples=["case.load.torque_n_m"])
    before: Value = Field(description="Its former value; null: not stated; of a long list its length")
    value: Value = Field(description="Its value here; null: not stated; of a long list its length")


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
    priority: int = Field(default=0, description="Of the computation: the highest of the jobs that share it")
    max_cost_s: float | None = Field(
        default=None, description="CPU seconds after which the computation is ended; null: no limit"
    )
    subject: str = Field(default="", description="What the job is about, in words: the pair, or the scene")
    differences: Differences | None = Field(default=None, description="What sets the job apart")
    message: str = Field(description="State of the job in words")
    created: str = Field(description="RFC 3339, UTC")
    started: str | None = None
    finished: str | None = None
    updated: str
    progress: int = Field(ge=0, le=100, description="Per cent of the whole job")
    remaining_s: float | None = Field(
        default=None, description="Seconds that a running job still needs, by its pace; null: not known yet"
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
    webhooks: list[WebhookState] | None = Field(
        default=None, description="Calls about the job; null in lists and events"
    )
    links: list[Link]


class JobInputs(BaseModel):
    """The inputs of a job: its process is executed with them again."""

    processID: str  # noqa: N815
    inputs: dict[str, Any] = Field(description="By name, as in an execution")


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
    """What is known of the file of a result; the figures of its kind are further members."""

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
    """Return the name of a process as those of its models begin."""
    return process.title().replace("-", "")
