"""The terms of a job, which the service stores with its inputs: label, priority, cost limit, delivery.

A job is one request of a caller. Jobs with equal inputs share one computation. The holder of an API key is
the caller; a key may limit priority and cost.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Literal, Self

from bounds import engineering
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import NETCDF
from service.access.capacity import KEYLESS
from service.access.holder import Holder
from service.queue.differences import NOT_COMPARED, differences_column
from service.schemas.answers import Differences

KEYLESS_CALLER = Holder(name=KEYLESS)
"""The caller of a service without keys."""

LOWER_COST = (
    "Select a coarser level, fewer positions, loads or samples, or a shorter run; or raise the limit."
)
"""Suggestion of a problem whose cost is above its limit."""
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
    """Raise `BadInput` if the sum of the predicted CPU seconds, by stage, is above a limit."""
    predicted = sum(stages.values())
    if predicted <= limit:
        return
    by_cost = sorted(stages.items(), key=lambda stage: -stage[1])
    parts = ", ".join(f"{name} {engineering(seconds, 2)} s" for name, seconds in by_cost[:2])
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
        return cls(row.title, tuple(row.tags.split()))  # a tag holds no blanks

    def columns(self) -> dict[str, str]:
        """Return the columns of the job table: the title, the title for searches, and one tag per line.

        Every tag stands between two line feeds, so that a search for a tag finds whole tags only.
        """
        lines = "".join(f"{tag}\n" for tag in self.tags)
        return {"title": self.title, "title_folded": self.title.casefold(), "tags": f"\n{lines}"}


NO_LABEL = Label()


@dataclass(frozen=True)
class Delivery:
    """The form of a result: raw, or a JSON document with an entry for each output.

    Each output is in it by value, or a reference (a link) stands for it, which raw results have in headers.
    """

    response: Response = "raw"
    transmission: Transmission = "value"

    @classmethod
    def of(cls, text: str) -> Self:
        """Return the delivery of a text that `str` of one has written."""
        response, _, transmission = text.partition(" ")
        return cls(response, transmission)  # type: ignore[arg-type]  # the table holds no others

    def __str__(self) -> str:
        return f"{self.response} {self.transmission}"


AS_IT_IS = Delivery()  # raw, by value


def delivery(response: Response, transmission: Transmission | None, field: str) -> Delivery:
    """Return the delivery that was requested; `field` is the name of the transmission in the request.

    Without a transmission a raw result is sent by value, and a document refers to it. Raises `BadInput`: a
    document by value is requested, but JSON does not hold netCDF.
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
    """The terms of a job."""

    delivery: Delivery = AS_IT_IS
    """Form of the result."""
    label: Label = NO_LABEL
    """Title and tags."""
    # a factory: a dataclass refuses a default whose class has no hash
    differences: Differences = field(default_factory=lambda: NOT_COMPARED)
    """Inputs in which the job differs from the previous job of its caller."""
    priority: int = 0
    """Priority of the job; a computation has the highest one of the jobs that share it."""
    max_cost_s: float | None = None
    """CPU seconds that the job may take; None: no limit."""
    stated: str = ""
    """Inputs as the caller wrote them, JSON; empty if the service does not store them."""
    reuse: bool = False
    """Whether an equal job of the same caller, under way or done, may answer in place of this one."""

    def columns(self) -> dict[str, str]:
        """Return the columns of the table of jobs; priority and cost are stored with the computation."""
        return {
            "delivery": str(self.delivery),
            "differences": differences_column(self.differences),
            "stated": self.stated,
            **self.label.columns(),
        }


USUAL = Terms()  # the terms of a job whose caller states none
