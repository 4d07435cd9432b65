"""The table ``[report]``: what a report is about, and what its figures must reach."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field, field_validator

from lineofaction.gearbox.schemas.model import BoundaryModel, Listed, refuse

_FORM = re.compile(r"(?P<figure>\S.*) at (?P<side>most|least) (?P<limit>[-+]?\d+(?:\.\d+)?) ?(?P<unit>.*)")
_REMEDY = 'For example "peak-to-peak STE at most 0.5 µm".'
Words = Annotated[str, Field(min_length=1, max_length=200)]


@dataclass(frozen=True)
class Requirement:
    """What a figure must reach: the beginning of its name, a limit and its unit as the report writes it."""

    words: str
    figure: str
    maximum: bool
    limit: float
    unit: str

    @classmethod
    def of(cls, words: str) -> Requirement | None:
        """Return what ``FIGURE at most|least NUMBER UNIT`` says; None: it has another form."""
        found = _FORM.fullmatch(words)
        if found is None:
            return None
        unit = found["unit"].replace("um", "µm")
        return cls(words, found["figure"], found["side"] == "most", float(found["limit"]), unit)


class ReportInput(BoundaryModel):
    """The title block of a report; no result depends on it."""

    title: Words | None = Field(default=None, description="In place of the title by its content")
    project: Words | None = Field(default=None, description="Project", examples=["EV reducer"])
    author: Words | None = Field(default=None, description="Who answers for it", examples=["A. Smith"])
    number: Words | None = Field(default=None, description="Number of the drawing", examples=["25-061"])
    revision: Words | None = Field(default=None, description="Its revision", examples=["B"])
    requirements: Listed[Words] = Field(
        default=(),
        max_length=20,
        description="What main results must reach: the beginning of a name, at most or at least, a number "
        "and the unit of the report; a result that is nearer to its limit than its error is open",
        examples=[["peak-to-peak STE at most 0.5 µm"]],
    )

    @field_validator("requirements")
    @classmethod
    def _say_a_limit(cls, requirements: tuple[str, ...]) -> tuple[str, ...]:
        for index, words in enumerate(requirements):
            if Requirement.of(words) is None:
                bound = "FIGURE at most NUMBER UNIT, or at least"
                refuse(f"requirements[{index}]", words, bound, _REMEDY)
        return requirements
