"""Inputs of a tolerance Monte Carlo: what it draws from, and how many pairs."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from service.schemas.model import BoundaryModel
from service.schemas.spelling import Spelling


class Inputs(BoundaryModel):
    """Tolerances of both gears by their class, and the sample."""

    tolerance_class: Annotated[int, Spelling("--class")] = Field(
        default=6,
        title="Class",
        ge=1,
        le=11,
        description="Class of ISO 1328-1:2013, both gears",
        examples=[6],
    )
    misalignment_um: float = Field(
        default=0.0, ge=0.0, le=1000.0, description="Tolerance of the misalignment, +- um", examples=[20.0]
    )
    distribution: Annotated[Literal["normal", "uniform"], Spelling("--uniform", "uniform")] = Field(
        default="normal",
        description="Within the tolerances: normal, three standard deviations wide and cut there, or uniform",
        examples=["normal"],
    )
    samples: int = Field(
        default=1000, title="Pairs", ge=2, le=1_000_000, description="Pairs to draw", examples=[1000]
    )
    seed: int = Field(default=0, ge=0, le=2**63 - 1, description="Equal seeds, equal results", examples=[0])
