"""Bodies of batches: many inputs of one process, and what came of them."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, Field

from lineofaction.gearbox.schemas.model import BoundaryModel
from service.schemas.execute import Cost, Priority
from service.schemas.label import Tags, Title
from service.schemas.ogc import JobStatus, ResultReference
from service.schemas.problem import ProblemBody
from service.schemas.subscriber import Subscriber

MOST_JOBS = 200
"""Of one batch: their inputs are checked while the caller waits, 4 to 40 ms each."""
_DEEPEST = 32


class BatchRequest(BoundaryModel):
    """Many inputs of one process, written as differences from what they share."""

    process: str = Field(max_length=64, description="Identifier of the process", examples=["analyze"])
    inputs: dict[str, Any] = Field(
        default_factory=dict, description="Inputs that the jobs share, as in an execution; default: none"
    )
    jobs: tuple[dict[str, Any], ...] = Field(
        strict=False,
        min_length=1,
        max_length=MOST_JOBS,
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
