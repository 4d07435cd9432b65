"""Bodies of executions: labels, inputs of processes, batches.

The bodies are those of OGC API Processes. An input is the value itself, or a qualified value: an object with
the value as its member "value" and its format beside it. A link in place of a value is refused. Models of
bodies are BoundaryModel, which refuses unknown fields; models of answers are BaseModel.
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field, create_model, model_validator

from lineofaction.gearbox.registry import JSON, NETCDF
from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.model import BoundaryModel, refuse
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.studied import CaseOrScene
from lineofaction.gearbox.study import Study
from service.schemas.answers import JobStatus, ProblemBody, ResultReference, Subscriber, class_name

Title = Annotated[str, Field(max_length=200, pattern=r"^[^\x00-\x1f\x7f]*$")]
Tag = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._:/+-]{0,39}$")]
Tags = Annotated[list[Tag], Field(max_length=16)]
Priority = Annotated[int, Field(ge=-9, le=9)]
Cost = Annotated[float, Field(gt=0.0, le=1e9)]
_FORMAT = {"mediaType", "encoding", "schema"}
"""Members of a qualified value in addition to "value"."""
_LINK = {"href", "rel", "type", "hreflang", "title"}
"""Members of a link."""
MAX_JOBS = 200
"""Most jobs of one batch: their inputs are checked while the caller waits, 4 to 40 ms each."""
_DEEPEST = 32
"""Most levels of a merge patch that are merged; inputs are nowhere nested as deeply."""


class LabelChange(BoundaryModel):
    """A change of a job's label; a member that is left out stays."""

    title: Title | None = Field(None, description="Name of the job", examples=["Tip relief 20 µm"])
    tags: Tags | None = Field(None, description="Replace the tags of the job", examples=[["ev-3", "draft"]])


class AnalyzeInputs(BoundaryModel):
    """Inputs of the process analyze."""

    case: Case = Field(description="The case, as in a case file")


class SimulateInputs(BoundaryModel):
    """Inputs of the process simulate."""

    scene: SceneInput = Field(description="The scene, with cases written out or databases by hash")


_SUBJECTS: dict[str, type[BoundaryModel]] = {
    "case": AnalyzeInputs,
    "scene": SimulateInputs,
    "case or scene": CaseOrScene,
}


@cache
def study_inputs(study: Study) -> type[BoundaryModel]:
    """Return the model of the inputs of a study's process: its subject, and its own inputs."""
    bases = (study.inputs, _SUBJECTS[study.takes.subject])
    text = f"Inputs of the process {study.name}."
    return create_model(f"{class_name(study.name)}Inputs", __base__=bases, __doc__=text)


class _ExecuteBody(BoundaryModel):
    """The base of the bodies of all executions: inputs may be qualified values."""

    @model_validator(mode="before")
    @classmethod
    def _unqualified(cls, body: Any) -> Any:
        """Return the body with plain values for qualified ones; refuse links and formats other than JSON."""
        if not isinstance(body, dict):
            return body
        inputs = body.get("inputs")
        if not isinstance(inputs, dict):
            return body
        return body | {"inputs": {name: _unqualified_value(name, value) for name, value in inputs.items()}}


def _unqualified_value(name: str, value: Any) -> Any:
    """Return the value of an input, plain or qualified; refuse a link, or a format other than JSON."""
    if not isinstance(value, dict):
        return value
    if "href" in value and set(value) <= _LINK:
        bound = "written out: the service reads no addresses that its callers name"
        refuse(f"inputs.{name}.href", value["href"], bound, "Send its content instead.")
    if "value" not in value or not set(value) <= _FORMAT | {"value"}:
        return value  # a plain value that happens to be an object
    for field in sorted(_FORMAT & set(value)):
        if field != "mediaType" or value[field] != JSON:
            bound = f"left out, or mediaType {JSON}"
            refuse(f"inputs.{name}.{field}", value[field], bound, "")  # no suggestion
    return value["value"]


@lru_cache(maxsize=1)
def _output_request() -> type[BoundaryModel]:
    """Return the model of the requested output in a body: its format, and by value or by reference."""
    type_field: Any = (Literal[NETCDF], Field(NETCDF, description="Media type of the output"))
    form = create_model("NcFormat", __base__=BoundaryModel, mediaType=type_field)
    text = "Default: value; in a document: reference"
    fields: dict[str, Any] = {
        "format": (form | None, Field(None, description="Format of the output")),
        "transmissionMode": (Literal["value", "reference"] | None, Field(None, description=text)),
    }
    return create_model("WantedNcOutput", __base__=BoundaryModel, **fields)


@cache
def execute_model(process: str, inputs: type[BoundaryModel], output: str) -> type[_ExecuteBody]:
    """Return the model of the body that executes a process.

    Parameters
    ----------
    process : str
        Identifier of the process.
    inputs : type[BoundaryModel]
        Model of the inputs of the process.
    output : str
        Name of the output; every process has one.
    """
    title = class_name(process)
    request: Any = (_output_request() | None, Field(None, description="The output of the process"))
    outputs = create_model(f"{title}Outputs", __base__=BoundaryModel, **{output: request})
    form = Field("raw", description="Form of the result: raw, or a JSON object of outputs by name")
    fields: dict[str, Any] = {
        "inputs": (inputs, Field(description="Inputs of the process")),
        "outputs": (outputs, Field(default_factory=outputs, description="Requested outputs; default: all")),
        "response": (Literal["raw", "document"], form),
        "title": (Title, Field("", description="Name of the job", examples=["Tip relief 20 µm"])),
        "priority": (
            Priority,
            Field(0, description="Turn of the job: the oldest of the highest is next", examples=[1]),
        ),
        "tags": (
            Tags,
            Field([], description="Tags by which lists find the job", examples=[["ev-3", "draft"]]),
        ),
        "subscriber": (Subscriber | None, Field(None, description="Addresses that are called about the job")),
        "max_cost_s": (
            Cost | None,
            Field(None, description="CPU seconds that the job may take; default: no limit", examples=[600.0]),
        ),
        "reuse": (
            bool,
            Field(False, description="Answer with the caller's equal job, if one is under way or done"),
        ),
    }
    return create_model(f"Execute{title}", __base__=_ExecuteBody, **fields)


class BatchRequest(BoundaryModel):
    """Many jobs of one process, written as shared inputs and the differences of each job."""

    process: str = Field(max_length=64, description="Identifier of the process", examples=["analyze"])
    inputs: dict[str, Any] = Field(
        default_factory=dict, description="Inputs that the jobs share, as in an execution; default: none"
    )
    jobs: tuple[dict[str, Any], ...] = Field(
        strict=False,
        min_length=1,
        max_length=MAX_JOBS,
        description="For each job its differences from the shared inputs, as a JSON merge patch",
        examples=[[{"case": {"load": {"torque_n_m": [100.0]}}}]],
    )
    title: Title = Field("", description="Name of the batch", examples=["Tip reliefs"])
    tags: Tags = Field([], description="Tags by which lists find the batch", examples=[["ev-3", "draft"]])
    priority: Priority = Field(0, description="Turn of its jobs", examples=[1])
    max_cost_s: Cost | None = Field(
        None, description="CPU seconds that each of its jobs may take; default: no limit", examples=[600.0]
    )

    subscriber: Subscriber | None = Field(None, description="Addresses that are called about the batch")

    def inputs_of(self, index: int) -> dict[str, Any]:
        """Return the inputs of one job: the shared ones with the differences of the job."""
        merged: dict[str, Any] = _merge_patch(self.inputs, self.jobs[index])
        return merged


class BatchResult(BaseModel):
    """Result of one job of a batch, by output, or the problem of a job without a result."""

    jobID: str  # noqa: N815
    status: JobStatus
    results: dict[str, ResultReference] | None = Field(description="Results by name of the output")
    problem: ProblemBody | None


class BatchResults(BaseModel):
    """Results of the jobs of a batch, in the sequence of the request."""

    jobs: list[BatchResult]


def _merge_patch(target: Any, patch: Any, levels: int = _DEEPEST) -> Any:
    """Return `target` with the changes of a JSON merge patch (RFC 7396): null removes a member.

    Objects are merged down to so many `levels`; below them the patch replaces the target.
    """
    if not isinstance(patch, dict) or levels == 0:
        return patch
    merged = dict(target) if isinstance(target, dict) else {}
    for name, value in patch.items():
        if value is None:
            merged.pop(name, None)
        else:
            merged[name] = _merge_patch(merged.get(name), value, levels - 1)
    return merged
