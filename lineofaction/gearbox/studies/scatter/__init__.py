"""Inputs and figures of a tolerance Monte Carlo: tolerances, distribution, number of pairs.

A deviation is one quantity of one gear, or the misalignment, that differs from the design within its
tolerance. The first pairs of the sample are analyzed whole. The others follow from a model: tangents about
some of the first pairs, whose error is measured on the rest of the first pairs.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from lineofaction.gearbox.schemas.figures import Figures, Json, Part, Source
from lineofaction.gearbox.schemas.model import BoundaryModel, Row
from lineofaction.gearbox.schemas.spelling import Spelling

Drawn = Annotated[str, Field(min_length=1, max_length=200)]


class ToleranceInputs(BoundaryModel):
    """Tolerances of both gears by their class or a drawing, and the sample."""

    tolerance_class: Annotated[int, Spelling("--class")] = Field(
        default=6,
        title="Class",
        ge=1,
        le=11,
        description="Tolerance class of ISO 1328-1:2013 of both gears",
        examples=[6],
    )
    finishing: Literal["any", "generating_grinding", "form_grinding", "honing", "shaving", "hobbing"] = Field(
        default="any",
        description="Finishing of the flanks. The part of the tolerances that all teeth have in common "
        "follows from it, as an assumption; any: the whole",
        examples=["generating_grinding"],
    )
    drawing: Row[Drawn] = Field(
        default=(),
        max_length=64,
        description="Tolerances of a drawing in place of those of the class, to either side: "
        "GEAR.FIGURE=VALUE, figure and unit as in the case file",
        examples=[["pinion.profile_slope_um=4", "wheel.helix_crowning_um=2"]],
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


class Inputs(ToleranceInputs):
    """Tolerances of both gears, the sample, the number of pairs that are analyzed in full, and a limit."""

    exact: int = Field(
        default=300,
        title="Pairs analyzed whole",
        ge=2,
        le=1_000_000,
        description="Number of pairs analyzed whole; further ones are by a model from a quarter of these, "
        "64 at most, held against the others",
        examples=[300],
    )
    population: Row[Drawn] = Field(
        default=(),
        max_length=64,
        description="Measured gears in place of the tolerances of the class: GEAR.FIGURE=MEAN/DEVIATION, in "
        "the unit of the figure, and GEAR.FIGURE*GEAR.FIGURE=CORRELATION (loa measured of a folder); helices "
        "deviate in no plane model",
        examples=[["wheel.profile_slope_um=-11.5/3.9", "wheel.helix_slope_um=2.1/0.2"]],
    )
    limit: str | None = Field(
        default=None,
        min_length=1,
        max_length=100,
        title="Limit on an order",
        description="Limit of the amplitude of an order of the transmission error: ORDER=VALUE in um, nm, or "
        "dB re 1 um. ORDER is a mesh order, with turns of a gear beside it (1-pinion, 2+wheel 3), or turns "
        "alone (pinion 2): teeth of that gear then differ, too. Left out: none",
        examples=["1=0.5um"],
    )


class ScatterFigures(Figures):
    """Peak-to-peak STE of the sampled pairs (rows) by torque, and their deviations (`names`)."""

    class QuantileFigures(Part):
        """A quantile by torque with its confidence bounds; None: the sample is too small for one."""

        fraction: float
        value_um: list[float]
        # A bound is infinite, or zero for the lower one, where the sample is too small for it.
        low_um: Annotated[
            list[float] | None, Source(lambda quantile: quantile.low if quantile.low.any() else None)
        ]
        high_um: Annotated[
            list[float] | None,
            Source(lambda quantile: quantile.high if all(map(math.isfinite, quantile.high)) else None),
        ]

    class AboveFigures(Part):
        """Pairs above a limit by torque; deciding deviations and cures at the worst torque."""

        name: Annotated[str, Source("limit.name")]
        order: Annotated[int, Source("limit.order")]
        gear: Annotated[str, Source("limit.gear")]
        turns: Annotated[int, Source("limit.turns")]
        """`name`, `order`, `gear`, `turns`: Limited order as the inputs name it; its mesh order; the gear and
        the number of its turns by which a sideband differs from the mesh order.
        """
        names: list[str]
        """Names of the deviations, the axis of `first_order`, `total` and `cured`."""
        limit_um: Annotated[float, Source("limit.amplitude")]
        nominal_um: list[float]
        """Amplitude without deviations, by torque."""
        share: list[float]
        low: list[float]
        high: list[float]
        """`share`, `low`, `high`: Part of all pairs that is above the limit, and its bounds, by torque."""
        missed_um: list[float]
        beyond: list[float]
        """`missed_um`, `beyond`: Error of the model in the amplitude of pairs analyzed whole, root mean
        square; and the part of them that it puts on the other side of the limit. By torque.
        """
        # the index of the torque at which most pairs are above the limit
        at_torque: Annotated[int, Source("load")]
        first_order: list[float]
        total: list[float]
        """`first_order`, `total`: Sobol' indices of the level in dB at that torque, by deviation."""
        cured: list[float]
        """Share at that torque with the tolerance of one deviation a class finer, by that deviation."""

    class ClassFigures(Part):
        """Pairs within the class by torque, where those of the study are of measured gears."""

        mean_um: list[float]
        share: list[float]
        decides: str
        """`share`, `decides`: Share of the pairs above the limit, and the deviation that decides there."""

    torque_n_m: list[float]
    samples: Annotated[int, Source(lambda study: len(study.peak_to_peak))]
    nominal_um: list[float]
    error_um: list[float]
    """`nominal_um`, `error_um`: Peak-to-peak without deviations, and the error of its analysis, by torque."""
    mean_um: list[float]
    mean_standard_error_um: Annotated[list[float], Source("mean_error")]
    confidence: float
    quantiles: list[QuantileFigures]
    names: list[str]
    """Names of the deviations, the columns of `deviation_um` and the rows of `influence`."""
    influence: list[list[float]]
    """Rank correlation of each deviation (rows) with the peak-to-peak, by torque (columns)."""
    # `solved` is 0 in a result without a model, in which all pairs are analyzed whole
    exact: Annotated[int, Source(lambda study: study.solved or len(study.peak_to_peak))]
    held: int
    """`exact`, `held`: Number of pairs analyzed in full, and number of pairs among them that measure the
    model's error."""
    missed_um: list[float]
    missed_largest_um: list[float]
    """`missed_um`, `missed_largest_um`: Error of the model in the peak-to-peak of the measured pairs, by
    torque: root mean square, and largest.
    """
    above: AboveFigures | None
    """Pairs above the limit; None if the inputs have no limit."""
    within_class: ClassFigures | None
    """Pairs within the class; None if no gear is measured."""
    deviation_um: list[list[float]]
    peak_to_peak_um: list[list[float]]
    first_order_um: list[list[float]]
    """`deviation_um`, `peak_to_peak_um`, `first_order_um`: One row a pair: deviations by name; peak-to-peak
    by torque; peak-to-peak by torque from the design and its derivatives alone.
    """
    cost: Json
    """CPU and wall seconds by stage."""
    asked: Json
    """Inputs of the study, as JSON."""
