"""Statements about an input before anything is computed: warnings, the plan of a run, its cost."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field

Recipe = dict[str, bool | int | float | list[int] | None]
"""Settings of a mesh by name; lengths in m."""
Point = Annotated[tuple[float, ...], Field(min_length=2, max_length=2)]


class InputWarning(BaseModel):
    """A value that is accepted and far from practice, or a part that an import left out of a scene."""

    check: str = Field(description="Name of the check")
    field: str
    value: float | None = Field(description="null: a part that is left out")
    unit: str
    low: float | None = Field(description="Lowest plausible value; null: none")
    high: float | None = Field(description="Highest plausible value; null: none")
    reason: str
    source: str = Field(description="Source of the bound")
    whole: str = Field(description="End of a question about the unit; may be empty")
    message: str = Field(description="The warning as a sentence")


def omission_warnings(texts: Iterable[str], of: str = "scene") -> list[dict[str, Any]]:
    """Return the omissions of an import from a scene or a case as warnings."""
    nothing = {"value": None, "unit": "", "low": None, "high": None, "reason": "", "source": "", "whole": ""}
    return [
        {
            "check": "left_out",
            "field": f"left_out[{index}]",
            **nothing,
            "message": f"left out of the {of}: {text}",
        }
        for index, text in enumerate(texts)
    ]


class PlannedCost(BaseModel):
    """Predicted cost of a run."""

    stages: dict[str, float] = Field(description="CPU seconds by stage")
    cpu_seconds: float
    correction: dict[str, float] = Field(description="Factor by stage from earlier runs on this machine")
    memory_bytes: int = Field(description="Largest resident memory of the process")
    positions: int = Field(
        description="Number of positions of the table; an expected number where positions are adaptive"
    )


class ModelBias(BaseModel):
    """Amount by which the gears exceed a plane model; ratios to the plane model's figures, with sign."""

    subject: str = Field(description="Plane model and face width in words")
    mean: float
    peak_to_peak: float | None = Field(description="Null where reliefs leave its sign open")
    either_way_um: float = Field(
        description="Largest change of peak-to-peak in µm if peak_to_peak is null, else 0"
    )
    error: float = Field(description="Error of the bias over the bias")
    visible_peak_to_peak: float = Field(
        description="Ratio for the peak-to-peak of flanks whose ripple no relief hides"
    )
    bending_ripple: float = Field(description="Peak-to-peak over the mean of unmodified flanks")
    words: str


class PlannedError(BaseModel):
    """Expected error of mean or peak-to-peak, whichever is worse; parts are relative."""

    mesh: float
    slices: float
    positions: float
    numerical: float = Field(description="Error of mesh, slices and positions together")
    plane: float = Field(description="Error of a plane model in place of three dimensions")
    method: float = Field(description="Error of the method, which no mesh lowers")
    total: float
    bias: ModelBias | None = Field(
        description="Bias of a plane model; part of `plane` and `total`, not of the errors in µm"
    )
    mean_um: float | None = Field(description="Null where no size is known before the run")
    peak_to_peak_um: float | None = Field(description="Null where no size is known before the run")


class PlannedStudy(BaseModel):
    """Predicted cost of a study with its usual inputs."""

    cpu_seconds: float
    memory_bytes: float = Field(description="Largest memory at one time; 0: unknown")
    words: str = Field(description="The cost as a sentence part: what is computed, how often, at what price")


class PlanBody(BaseModel):
    """The plan of an analysis."""

    class LedgerEntry(BaseModel):
        """An effect: whether it is on, why, its influence and its cost."""

        class EffectInfluence(BaseModel):
            """The change by an effect, estimated before the run."""

            torque_n_m: float = Field(description="Torque of the estimate")
            misalignment_um: float = Field(description="Misalignment of the estimate")
            mean_um: float | None = Field(description="Change of the mean transmission error")
            peak_to_peak_um: float | None = Field(description="Change of its peak-to-peak")
            whole_mean_um: float | None = Field(description="The mean with the effect")
            whole_peak_to_peak_um: float | None = Field(description="Peak-to-peak with the effect")
            relative_mean: float | None
            relative_peak_to_peak: float | None
            trifle: bool = Field(description="Whether it is below what any tolerance asks for")
            words: str

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

    class PlannedMesh(BaseModel):
        """The mesh that would be taken, and why."""

        model: str
        level: str
        slices: int
        met: bool = Field(description="Whether the request is expected to be met")
        reason: str

    class PlannedLevel(BaseModel):
        """A mesh level, or the level that the tolerance needs without the time budget: cost and error."""

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
        slices: int | None = Field(
            default=None, description="Number of slices of the common face width; null: a plane model"
        )
        patch: dict[str, float] = Field(description="Sizes of the load patches in m, and their load")
        positions: int | Literal["adaptive"] = Field(description="Number of positions in one base pitch")
        load: list[float] = Field(description="Normal forces in N")
        support_load: list[float] = Field(description="Further normal forces in N, for the force extraction")

    choice: PlannedMesh
    prediction: PlannedCost
    error: PlannedError
    levels: list[PlannedLevel]
    passes: list[PlannedLevel] = Field(description="The mesh, and the one expected to follow if it is tried")
    conflict: str = Field(description="Why tolerance and time cannot both be had; empty if they can")
    plan: PlannedRun = Field(description="Meshes, patches, positions and loads")
    warnings: list[InputWarning]
    effect_ledger: list[LedgerEntry] = Field(description="Decision and reason for each effect")
    study: PlannedStudy | None = Field(
        default=None, description="Cost of the study that the question names; null: none, or not predicted"
    )
