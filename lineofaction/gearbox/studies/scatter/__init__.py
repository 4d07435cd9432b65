"""Inputs of a tolerance Monte Carlo: what it draws from, and how many pairs."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.spelling import Spelling


class Inputs(BoundaryModel):
    """Tolerances of both gears by their class, and the sample."""

    tolerance_class: Annotated[int, Spelling("--class")] = Field(
        default=6,
        title="Class",
        ge=1,
        le=11,
        description="Tolerance class of ISO 1328-1:2013 of both gears",
        examples=[6],
    )
    misalignment_um: float = Field(
        default=0.0,
        ge=0.0,
        le=1000.0,
        description="Tolerance of the misalignment in um, to either side",
        examples=[20.0],
    )
    distribution: Annotated[Literal["normal", "uniform"], Spelling("--uniform", "uniform")] = Field(
        default="normal",
        description="Distribution within the tolerances: normal with three standard deviations at the limit, "
        "truncated there, or uniform",
        examples=["normal"],
    )
    samples: int = Field(
        default=1000,
        title="Pairs",
        ge=2,
        le=1_000_000,
        description="Number of pairs to sample",
        examples=[1000],
    )
    seed: int = Field(
        default=0,
        ge=0,
        le=2**63 - 1,
        description="Seed of the sample; equal seeds give equal results",
        examples=[0],
    )
