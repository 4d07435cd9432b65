"""What a run will be and cost: the answer to a plan."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, Field


class PlannedCost(BaseModel):
    """Predicted cost of a run."""

    stages: dict[str, float] = Field(description="CPU seconds by stage")
    cpu_seconds: float
    correction: dict[str, float] = Field(description="Factor by stage from earlier runs on this machine")
    memory_bytes: int = Field(description="Largest resident memory of the process")
    positions: int = Field(description="Of the table; expected where they are adaptive")


class PlannedError(BaseModel):
    """Expected error of mean or peak-to-peak, whichever is worse; parts are relative."""

    mesh: float
    slices: float
    model: float
    positions: float
    method: float
    total: float
    mean_m: float | None = Field(description="Null where no size is known before the run")
    peak_to_peak_m: float | None = Field(description="Null where no size is known before the run")


class PlannedMesh(BaseModel):
    """The mesh that would be taken, and why."""

    model: str
    level: str
    slices: int
    met: bool = Field(description="Whether the request is expected to be met")
    reason: str


class PlannedLevel(BaseModel):
    """A mesh level of the same model: cost and error."""

    level: str
    slices: int
    cost: PlannedCost
    error: PlannedError


class PlanBody(BaseModel):
    """The plan of an analysis."""

    choice: PlannedMesh
    prediction: PlannedCost
    error: PlannedError
    levels: list[PlannedLevel]
    conflict: str = Field(description="Why tolerance and time cannot both be had; empty if they can")
    plan: dict[str, Any] = Field(description="Meshes, patches, positions and loads")
    warnings: list[dict[str, Any]]
    effect_ledger: list[dict[str, Any]] = Field(description="Decision and reason for each effect")
