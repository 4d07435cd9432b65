"""Speeds at which steady states are looked for."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from lineofaction.gearbox.schemas.figures import Figures, Ledger, Part, ReductionCosts, Seconds
from lineofaction.gearbox.schemas.model import Row
from lineofaction.gearbox.schemas.studied import MAX_SPEEDS, OverSpeeds, TurningSpeed


class Inputs(OverSpeeds):
    """Speeds at which steady states are looked for, each by shooting."""

    usual_speeds: ClassVar[int] = 30
    speed_rpm: Row[TurningSpeed] = Field(
        min_length=1,
        max_length=MAX_SPEEDS,
        description="Speeds of the first driven shaft in rpm, increasing",
        examples=[[11000.0, 12000.0, 13000.0]],
    )
    branch: bool = Field(
        default=True,
        description="Follow the branch of solutions from the lowest to the highest speed, unstable parts "
        "included",
        examples=[True],
    )
    repeat: Annotated[int, Field(ge=1, le=16)] = Field(
        default=1, description="Period of the motions in common periods of the meshes", examples=[1]
    )
    settling_periods: Annotated[int, Field(ge=0, le=100_000)] = Field(
        default=64, description="Periods of settling at each speed of a sweep", examples=[64]
    )


class SteadyMotion(Part):
    """A motion at a speed; of one that was not found only how the search ended."""

    class MeshMotion(Part):
        """A mesh over a period; parts of it are without contact or on the coast flank."""

        mean_error_um: float
        rms_error_um: float
        peak_to_peak_error_um: float
        least_force_n: float
        largest_force_n: float
        parted: float
        coasting: float

    class BearingMotion(Part):
        """A bearing over a period."""

        rms_force_n: float

    speed_rpm: float
    status: str
    iterations: int
    residual_um: float | None = None
    step_error_um: float | None = None
    stability: str | None = None
    largest_multiplier: tuple[float, float] | None = None
    meshes: dict[str, MeshMotion] | None = None
    bearings: dict[str, BearingMotion] | None = None


class SteadyFigures(Figures):
    """Motions of both sweeps and of the branch, jumps and bifurcations."""

    class BranchFigures(Part):
        """The branch that was followed, unstable parts included."""

        status: str
        points: list[SteadyMotion]

    class Bifurcation(Part):
        """A speed at which a motion changes its stability."""

        kind: str
        speed_rpm: float

    class Jump(Part):
        """The speeds between which a sweep jumps."""

        sweep: Literal["up", "down"]
        between_rpm: tuple[float, float]

    leading_shaft: str
    period_pitches: dict[str, int]
    up: list[SteadyMotion]
    down: list[SteadyMotion]
    branch: BranchFigures
    bifurcations: list[Bifurcation]
    jumps: list[Jump]
    steps_per_period: int
    cpu_seconds: Seconds
    reduction_cost: ReductionCosts
    effect_ledger: Ledger
