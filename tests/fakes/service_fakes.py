"""Small processes that stand in for analyze and simulate: they end, fail, hang or die on request."""

from typing import Any, Literal

from pydantic import Field

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.model import BoundaryModel
from service.store.results import ResultStore
from service.worker.process import Process, Registry, Stage


class Wish(BoundaryModel):
    """What the fake is to do."""

    mode: Literal[
        "write",
        "hang",
        "burn",
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
        "condense",
        "warn",
        "sign",
    ] = "write"
    text: str = Field(default="", max_length=1_000_000)
    number: float = Field(default=0.0, ge=0.0, le=10.0)


class FakeInputs(BoundaryModel):
    """Inputs of the fake."""

    wish: Wish


def prepare(inputs: BoundaryModel, _store: ResultStore) -> dict[str, Any]:
    assert isinstance(inputs, FakeInputs)
    if inputs.wish.mode == "refuse":
        raise BadInput.of("mode", "refuse", "anything else", "Try write.")
    return inputs.model_dump(mode="json")


FAKE = Process(
    id="fake",
    title="Fake",
    description="Ends, fails, hangs or dies on request",
    version="1",
    inputs=FakeInputs,
    output="database",
    kind="database",
    prepare=prepare,
    entry="service_fake_work:work",
    stages=(Stage("first", 0.25), Stage("second", 0.75)),
)
REGISTRY = Registry(FAKE)
EXECUTION = "/v1/processes/fake/execution"


def bearing(key: str) -> dict[str, str]:
    """Return the header with an access key."""
    return {"Authorization": f"Bearer {key}"}
