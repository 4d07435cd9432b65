"""Small processes that stand in for analyze and simulate: they end, fail, hang or die on request."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

from pydantic import Field

from service.jobs.process import Process, Registry, Stage
from service.problems import BadInput
from service.schemas.model import BoundaryModel
from service.store import ResultStore


class Wish(BoundaryModel):
    """What the stand-in is to do."""

    mode: Literal[
        "write",
        "hang",
        "die",
        "die_once",
        "abort",
        "hog",
        "full",
        "mesh",
        "input",
        "defect",
        "refuse",
        "slow",
    ] = "write"
    text: str = Field(default="", max_length=1_000_000)
    number: float = Field(default=0.0, ge=0.0, le=10.0)


class StandInInputs(BoundaryModel):
    """Inputs of the stand-in."""

    wish: Wish


def prepare(inputs: BoundaryModel, _store: ResultStore) -> dict[str, Any]:
    """Refuse on request, as an infeasible pair is refused."""
    assert isinstance(inputs, StandInInputs)
    if inputs.wish.mode == "refuse":
        raise BadInput.of("mode", "refuse", "anything else", "Try write.")
    return inputs.model_dump(mode="json")


STAND_IN = Process(
    id="standin",
    title="Stand-in",
    description="Ends, fails, hangs or dies on request",
    version="1",
    inputs=StandInInputs,
    output="database",
    kind="database",
    prepare=prepare,
    entry="service_stand_in_work:work",
    stages=(Stage("first", 0.25), Stage("second", 0.75)),
)
REGISTRY = Registry(STAND_IN)
REPORT = replace(
    STAND_IN, id="report", output="ablation", kind="ablation", entry="service_stand_in_work:report"
)
"""One whose results are JSON."""
