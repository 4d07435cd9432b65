"""The effect ledger as answers have it."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, Field


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
