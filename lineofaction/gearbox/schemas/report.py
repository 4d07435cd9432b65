"""The table ``[report]``: the subject of a report, and requirements on its figures."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field, field_validator

from lineofaction.gearbox.schemas.model import BoundaryModel, Listed, refuse

_FORM = re.compile(r"(?P<figure>\S.*) at (?P<side>most|least) (?P<limit>[-+]?\d+(?:\.\d+)?) ?(?P<unit>.*)")
_REMEDY = 'For example "peak-to-peak STE at most 0.5 µm".'
ShortText = Annotated[str, Field(min_length=1, max_length=200)]


@dataclass(frozen=True)
class Requirement:
    """A limit on a figure of the report: the beginning of its name, the limit, the unit as in the report."""

    text: str
    figure: str
    maximum: bool
    limit: float
    unit: str

    @classmethod
    def of(cls, text: str) -> Requirement | None:
        """Return the requirement of ``FIGURE at most|least NUMBER UNIT``; None: it has another form."""
        match = _FORM.fullmatch(text)
        if match is None:
            return None
        unit = match["unit"].replace("um", "µm")
        return cls(text, match["figure"], match["side"] == "most", float(match["limit"]), unit)


class ReportInput(BoundaryModel):
    """The title block of a report; no result depends on it."""

    title: ShortText | None = Field(default=None, description="Title; left out: a title by the content")
    project: ShortText | None = Field(default=None, description="Project", examples=["EV reducer"])
    author: ShortText | None = Field(default=None, description="Author of the report", examples=["A. Smith"])
    number: ShortText | None = Field(default=None, description="Number of the drawing", examples=["25-061"])
    revision: ShortText | None = Field(default=None, description="Revision of the drawing", examples=["B"])
    requirements: Listed[ShortText] = Field(
        default=(),
        max_length=20,
        description="Requirements on main results: the beginning of a name, at most or at least, a number "
        "and the unit of the report; a result that is nearer to its limit than its error is "
        "open",
        examples=[["peak-to-peak STE at most 0.5 µm"]],
    )

    @field_validator("requirements")
    @classmethod
    def _say_a_limit(cls, requirements: tuple[str, ...]) -> tuple[str, ...]:
        for index, text in enumerate(requirements):
            if Requirement.of(text) is None:
                bound = "FIGURE at most NUMBER UNIT, or at least"
                refuse(f"requirements[{index}]", text, bound, _REMEDY)
        return requirements
