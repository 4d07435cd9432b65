"""What is implausible about an input, or left out of it, as answers have it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from pydantic import BaseModel, Field


class InputWarning(BaseModel):
    """A value that is accepted and far from practice, or a part that an import left out of a scene."""

    check: str = Field(description="Name of the check")
    field: str
    value: float | None = Field(description="null: a part that is left out")
    unit: str
    low: float | None = Field(description="Lowest plausible value; null: none")
    high: float | None = Field(description="Highest plausible value; null: none")
    reason: str
    source: str = Field(description="Where the bound comes from")
    whole: str = Field(description="What a question about the unit ends with; may be empty")
    message: str = Field(description="All of it as a sentence")


def left_out_warnings(texts: Iterable[str]) -> list[dict[str, Any]]:
    """Return what an import left out of a scene as warnings."""
    nothing = {"value": None, "unit": "", "low": None, "high": None, "reason": "", "source": "", "whole": ""}
    return [
        {
            "check": "left_out",
            "field": f"left_out[{index}]",
            **nothing,
            "message": f"left out of the scene: {text}",
        }
        for index, text in enumerate(texts)
    ]
