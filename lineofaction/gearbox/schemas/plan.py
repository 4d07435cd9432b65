"""What a run will be and cost: the answer to a plan."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, Field

from lineofaction.gearbox.schemas.warning import InputWarning

# The effect ledger as answers have it.


class EffectInfluence(BaseModel):
    """The change by an effect, estimated before the run."""

    torque_n_m: float = Field(description="Torque of the estimate")
    misalignment_m: float = Field(description="Misalignment of the estimate")
    mean_m: float | None = Field(description="Change of the mean transmission error")
    peak_to_peak_m: float | None = Field(description="Change of its peak-to-peak")
    whole_mean_m: float | None = Field(description="The mean with the effect")
    whole_peak_to_peak_m: float | None = Field(description="Peak-to-peak with the effect")
    relative_mean: float | None
    relative_peak_to_peak: float | None
    trifle: bool = Field(description="Whether it is below what any tolerance asks for")
    words: str


class LedgerEntry(BaseModel):
    """An effect: whether it is on, why, its influence and its cost."""

    name: str
    on: bool
    choice: Literal["on", "off", "auto"]
    cost: str = Field(description="The cost in words")
    called_for: bool = Field(description="Whether the scene calls for it")
    reason: str
    decision: str
    influence: EffectInfluence | None = Field(description="Null: not estimated")
    cost_cpu_seconds: float | None = Field(description="Predicted CPU time that it adds; null: not known")
    price: str
    checked: str = Field(description="Assumptions that were checked after the run")
    holds: bool | None = Field(description="Whether they hold; null: not checked")


Recipe = dict[str, bool | int | float | list[int] | None]
"""Settings of a mesh by name; lengths in m."""


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
    """A mesh level of the model, or what the tolerance needs beyond the time: cost and error."""

    model: str
    level: str
    slices: int
    cost: PlannedCost
    error: PlannedError


class PlannedRun(BaseModel):
    """The discretization of the run."""

    model: str
    mesh: list[Recipe] = Field(description="Meshes of the driving and of the driven gear, lengths in m")
    finite_width: list[Recipe] | None = Field(
        default=None, description="Meshes that correct a plane model for the finite width"
    )
    slices: int | None = Field(default=None, description="Of the common face width; plane models have none")
    patch: dict[str, float] = Field(description="Sizes of the load patches in m, and their load")
    positions: int | Literal["adaptive"] = Field(description="In one base pitch")
    load: list[float] = Field(description="Normal forces in N")
    support_load: list[float] = Field(description="Further normal forces in N, for the force extraction")


class PlanBody(BaseModel):
    """The plan of an analysis."""

    choice: PlannedMesh
    prediction: PlannedCost
    error: PlannedError
    levels: list[PlannedLevel]
    conflict: str = Field(description="Why tolerance and time cannot both be had; empty if they can")
    plan: PlannedRun = Field(description="Meshes, patches, positions and loads")
    warnings: list[InputWarning]
    effect_ledger: list[LedgerEntry] = Field(description="Decision and reason for each effect")
