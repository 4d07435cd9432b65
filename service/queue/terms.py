"""What is kept of a job beside its inputs: caller, priority, label, delivery."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Literal, Self

from bounds import engineering
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import NETCDF
from service.access.holder import Holder
from service.queue.differences import NOT_COMPARED, differences_column
from service.schemas.answers import Differences

ANYBODY = Holder(name="")
"""The caller of a service without keys."""

LOWER_COST = (
    "Select a coarser level, fewer positions, loads or samples, of a run a shorter one; or raise the limit."
)
Response = Literal["raw", "document"]
Transmission = Literal["value", "reference"]
Json = dict[str, Any]


def check_priority(priority: int, caller: Holder) -> None:
    """Raise `BadInput` if a caller may not have this priority."""
    highest = caller.highest_priority
    if highest is not None and priority > highest:
        bound = f"at most {highest}, the limit of key {caller.name!r}"
        raise BadInput.of("priority", priority, bound, "Leave it out, or ask the operator of the service.")


def cost_limit(requested: float | None, caller: Holder) -> float | None:
    """Return the CPU seconds that a job may take: as requested, and no more than its caller's key allows."""
    return min((limit for limit in (requested, caller.max_cost_s) if limit is not None), default=None)


def refuse_beyond(limit: float, stages: dict[str, float]) -> None:
    """Raise `BadInput` if the predicted CPU seconds, by stage, are beyond a limit."""
    predicted = sum(stages.values())
    if predicted <= limit:
        return
    largest = sorted(stages.items(), key=lambda stage: -stage[1])[:2]
    parts = ", ".join(f"{name} {engineering(seconds, 2)} s" for name, seconds in largest)
    bound = f"at least the predicted cost, {engineering(predicted, 3)} CPU s ({parts})"
    raise BadInput.of("max_cost_s", limit, bound, LOWER_COST)


@dataclass(frozen=True)
class Label:
    """Title and tags (in lower case, each once) of a job; they say nothing about the work."""

    title: str = ""
    tags: tuple[str, ...] = ()

    @classmethod
    def of(cls, title: str, tags: Iterable[str]) -> Self:
        """Return the label that a caller writes: without outer spaces, tags in lower case and each once."""
        return cls(title.strip(), tuple(dict.fromkeys(tag.lower() for tag in tags)))

    @classmethod
    def from_row(cls, row: Any) -> Self:
        """Return the label of a row of the job table."""
        return cls(row.title, tuple(row.tags.split()))

    def columns(self) -> dict[str, str]:
        """Return it as the job table has it: the title also as it is searched, tags one a line."""
        lines = "".join(f"{tag}\n" for tag in self.tags)
        return {"title": self.title, "title_folded": self.title.casefold(), "tags": f"\n{lines}"}


NO_LABEL = Label()


@dataclass(frozen=True)
class Delivery:
    """The form of a result: itself or links in headers (raw), or a JSON object by name of output."""

    response: Response = "raw"
    transmission: Transmission = "value"

    @classmethod
    def of(cls, text: str) -> Self:
        """Return what `str` wrote."""
        response, _, transmission = text.partition(" ")
        return cls(response, transmission)  # type: ignore[arg-type]  # the table holds no others

    def __str__(self) -> str:
        return f"{self.response} {self.transmission}"


AS_IT_IS = Delivery()


def delivery(response: Response, transmission: Transmission | None, field: str) -> Delivery:
    """Return the form that was requested; without a transmission by value, but in a document by reference.

    Raises `BadInput`, by the caller's name of the `field`: by value in a document, as JSON does not hold
    netCDF.
    """
    if response == "document":
        if transmission == "value":
            bound = f"reference in a document: JSON does not hold {NETCDF}"
            raise BadInput.of(
                field, transmission, bound, 'Request the response "raw" to get the file itself.'
            )
        return Delivery(response, "reference")
    return Delivery(response, transmission or "value")


@dataclass(frozen=True)
class Terms:
    """The terms of a job.

    Its computation has the highest priority of the jobs that share it, and may cost `max_cost_s` CPU seconds
    (None: no limit). `stated` are its inputs as the caller stated them, JSON; empty: they are not kept. With
    `reuse` an equal job of the caller's that is under way or done answers in its place.
    """

    delivery: Delivery = AS_IT_IS
    label: Label = NO_LABEL
    differences: Differences = field(default_factory=lambda: NOT_COMPARED)
    priority: int = 0
    max_cost_s: float | None = None
    stated: str = ""
    reuse: bool = False

    def columns(self) -> dict[str, str]:
        """Return the columns of a job that hold them; the others are its computation's."""
        said = {
            "delivery": str(self.delivery),
            "differences": differences_column(self.differences),
            "stated": self.stated,
        }
        return {**said, **self.label.columns()}


USUAL = Terms()
