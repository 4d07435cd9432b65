"""Bodies of executions (OGC 18-062r2, clause 7.11.1): inputs, the output wanted, and its form."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, Any, Literal

from pydantic import Field, create_model, model_validator

from lineofaction.gearbox.registry import JSON, NETCDF
from lineofaction.gearbox.schemas.model import BoundaryModel, refuse
from service.schemas.label import Tags, Title
from service.schemas.ogc import class_name
from service.schemas.subscriber import Subscriber

_FORMAT = {"mediaType", "encoding", "schema"}
Priority = Annotated[int, Field(ge=-9, le=9)]
Cost = Annotated[float, Field(gt=0.0, le=1e9)]
_LINK = {"href", "rel", "type", "hreflang", "title"}


class ExecuteBody(BoundaryModel):
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


def execute_model(process: str, inputs: type[BoundaryModel], output: str) -> type[ExecuteBody]:
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
        "title": (Title, Field("", description="Name of the job", examples=["Tip relief 20 um"])),
        "priority": (
            Priority,
            Field(0, description="Turn of the job: the oldest of the highest is next", examples=[1]),
        ),
        "tags": (Tags, Field([], description="What the job is found by", examples=[["ev-3", "draft"]])),
        "subscriber": (Subscriber | None, Field(None, description="Who is told about the job")),
    }
    fields["max_cost_s"] = (
        Cost | None,
        Field(None, description="CPU seconds that the job may take; default: no limit", examples=[600.0]),
    )
    fields["reuse"] = (
        bool,
        Field(False, description="Answer with the caller's equal job, if one is under way or done"),
    )
    return create_model(f"Execute{title}", __base__=ExecuteBody, **fields)
