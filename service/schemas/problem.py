"""The one error body (RFC 9457), for the OpenAPI document."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, Field


class FaultBody(BaseModel):
    """One thing wrong with the input."""

    field: str = Field(examples=["pair.pinion.bore_diameter_mm"])
    value: Any = Field(examples=[95.0])
    bound: str = Field(examples=["from 4 to 66.9"])
    suggestion: str = Field(examples=["Make the bore smaller."])


class ProblemBody(BaseModel):
    """Problem details."""

    type: str = Field(examples=["urn:lineofaction:problem:bad-input"])
    title: str = Field(examples=["The input cannot be used"])
    status: int = Field(examples=[422])
    detail: str
    errors: list[FaultBody]
    reference: str | None = Field(
        default=None, description="Number of the log entry of an unexpected failure"
    )
