"""Bodies of executions: labels, inputs of processes, batches."""

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
_FORMAT = {"mediaType", "encoding", "schema"}
Priority = Annotated[int, Field(ge=-9, le=9)]
Cost = Annotated[float, Field(gt=0.0, le=1e9)]
_LINK = {"href", "rel", "type", "hreflang", "title"}
MAX_JOBS = 200
"""Of one batch: their inputs are checked while the caller waits, 4 to 40 ms each."""
_DEEPEST = 32


class LabelChange(BoundaryModel):
    """A change of a job's label; what is left out stays."""

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
    """Return the model of the inputs of a study's process: what is studied, and what is varied."""
    bases = (study.inputs, _SUBJECTS[study.takes.subject])
    text = f"Inputs of the process {study.name}."
    return create_model(f"{class_name(study.name)}Inputs", __base__=bases, __doc__=text)


class _ExecuteBody(BoundaryModel):
    """The base of the bodies of all executions: inputs may be qualified values."""

    @model_validator(mode="before")
    @classmethod
    def _as_offered(cls, body: Any) -> Any:
        """Refuse what is not offered, and take values out of their qualification."""
        if not isinstance(body, dict):
            return body
        inputs = body.get("inputs")
        if not isinstance(inputs, dict):
            return body
        return body | {"inputs": {name: _value(name, value) for name, value in inputs.items()}}


def _value(name: str, value: Any) -> Any:
    """Return an input without the qualification it may have."""
    if not isinstance(value, dict):
        return value
    if "href" in value and set(value) <= _LINK:
        bound = "written out: the service reads no addresses that its callers name"
        refuse(f"inputs.{name}.href", value["href"], bound, "Send its content instead.")
    if "value" not in value or not set(value) <= _FORMAT | {"value"}:
        return value
    for field in sorted(_FORMAT & set(value)):
        if field != "mediaType" or value[field] != JSON:
            refuse(f"inputs.{name}.{field}", value[field], f"left out, or mediaType {JSON}", "")
    return value["value"]


@lru_cache(maxsize=1)
def _wanted_output() -> type[BoundaryModel]:
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
    """Return the model of a process' body.

    Parameters
    ----------
    process : str
        Its identifier.
    inputs : type[BoundaryModel]
        Model of its inputs.
    output : str
        Name of its one output.
    """
    title = class_name(process)
    wanted: Any = (_wanted_output() | None, Field(None, description="The output of the process"))
    outputs = create_model(f"{title}Outputs", __base__=BoundaryModel, **{output: wanted})
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
        "tags": (Tags, Field([], description="What the job is found by", examples=[["ev-3", "draft"]])),
        "subscriber": (Subscriber | None, Field(None, description="Who is told about the job")),
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
    """Many inputs of one process, written as differences from what they share."""

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
    tags: Tags = Field([], description="What the batch is found by", examples=[["ev-3", "draft"]])
    priority: Priority = Field(0, description="Turn of its jobs", examples=[1])
    max_cost_s: Cost | None = Field(
        None, description="CPU seconds that each of its jobs may take; default: no limit", examples=[600.0]
    )

    subscriber: Subscriber | None = Field(None, description="Who is told about the batch")

    def inputs_of(self, index: int) -> dict[str, Any]:
        """Return the inputs of one job."""
        merged: dict[str, Any] = _merge_patch(self.inputs, self.jobs[index])
        return merged


class BatchResult(BaseModel):
    """What came of one job of a batch: its results by output, or the problem why there are none."""

    jobID: str  # noqa: N815
    status: JobStatus
    results: dict[str, ResultReference] | None = Field(description="By name of the output")
    problem: ProblemBody | None


class BatchResults(BaseModel):
    """What came of the jobs of a batch, in the order of the request."""

    jobs: list[BatchResult]


def _merge_patch(target: Any, patch: Any, deepest: int = _DEEPEST) -> Any:
    """Return `target` with the changes of a JSON merge patch (RFC 7396): null removes a member.

    What lies deeper than any inputs do is replaced as it is.
    """
    if not isinstance(patch, dict) or deepest == 0:
        return patch
    merged = dict(target) if isinstance(target, dict) else {}
    for name, value in patch.items():
        if value is None:
            merged.pop(name, None)
        else:
            merged[name] = _merge_patch(merged.get(name), value, deepest - 1)
    return merged
