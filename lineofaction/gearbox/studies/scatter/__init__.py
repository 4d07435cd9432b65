"""Inputs of a tolerance Monte Carlo: what it draws from, and how many pairs."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from lineofaction.gearbox.schemas.figures import Figures, Json, Part, Source
from lineofaction.gearbox.schemas.model import BoundaryModel, Spelling


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
        description="Tolerance of the misalignment in µm, to either side",
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


class ScatterFigures(Figures):
    """Peak-to-peak STE of the sampled pairs (rows) by torque, and by what they deviate (`names`)."""

    class QuantileFigures(Part):
        """A quantile by torque with its confidence bounds; None: the sample is too small for one."""

        fraction: float
        value_um: list[float]
        low_um: Annotated[list[float] | None, Source(lambda own: own.low if own.low.any() else None)]
        high_um: Annotated[
            list[float] | None, Source(lambda own: own.high if all(map(math.isfinite, own.high)) else None)
        ]

    torque_n_m: list[float]
    samples: Annotated[int, Source(lambda study: len(study.peak_to_peak))]
    nominal_um: list[float]
    error_um: list[float]
    mean_um: list[float]
    mean_standard_error_um: Annotated[list[float], Source("mean_error")]
    confidence: float
    quantiles: list[QuantileFigures]
    names: list[str]
    influence: list[list[float]]
    deviation_um: list[list[float]]
    peak_to_peak_um: list[list[float]]
    first_order_um: list[list[float]]
    cost: Json
    asked: Json
