"""What is implausible about an input, as answers have it."""

from __future__ import annotations

from pydantic import BaseModel, Field


class InputWarning(BaseModel):
    """A value that is accepted and far from practice."""

    check: str = Field(description="Name of the check")
    field: str
    value: float
    unit: str
    low: float | None = Field(description="Lowest plausible value; null: none")
    high: float | None = Field(description="Highest plausible value; null: none")
    reason: str
    source: str = Field(description="Where the bound comes from")
    whole: str = Field(description="What a question about the unit ends with; may be empty")
    message: str = Field(description="All of it as a sentence")
