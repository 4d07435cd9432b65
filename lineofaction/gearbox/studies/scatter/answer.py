"""Figures of a tolerance Monte Carlo."""

from __future__ import annotations

from lineofaction.gearbox.schemas.figures import Figures, Json, Part


class QuantileFigures(Part):
    """A quantile by torque with its confidence bounds; None: the sample is too small for one."""

    fraction: float
    value_um: list[float]
    low_um: list[float] | None
    high_um: list[float] | None


class ScatterFigures(Figures):
    """Peak-to-peak STE of the sampled pairs (rows) by torque, and by what they deviate (`names`)."""

    torque_n_m: list[float]
    samples: int
    nominal_um: list[float]
    error_um: list[float]
    mean_um: list[float]
    mean_standard_error_um: list[float]
    confidence: float
    quantiles: list[QuantileFigures]
    names: list[str]
    influence: list[list[float]]
    deviation_um: list[list[float]]
    peak_to_peak_um: list[list[float]]
    first_order_um: list[list[float]]
    cost: Json
    asked: Json


ANSWER = ScatterFigures
