"""A tolerance Monte Carlo read back from the JSON that it was stored as."""

from __future__ import annotations

import math

import numpy as np

from fe_contact.microgeometry import ToleranceStudy
from fe_contact.microgeometry.spread import Quantile
from service.report.figure import FloatArray
from service.report.stored_ladder import Json
from service.units import UM


def stored_scatter(content: Json) -> ToleranceStudy:
    """Return the study in `content` (`scatter_json`); what was requested stays in boundary units."""
    return ToleranceStudy(
        np.array(content["torque_n_m"], dtype=float),
        tuple(name.rpartition("_")[0] for name in content["names"]),
        _lengths(content["deviation_um"]),
        _lengths(content["peak_to_peak_um"]),
        _lengths(content["nominal_um"]),
        _lengths(content["error_um"]),
        tuple(_quantile(one, len(content["torque_n_m"])) for one in content["quantiles"]),
        _lengths(content["first_order_um"]),
        content["confidence"],
        content["cost"],
        content["asked"],
    )


def _lengths(values: list[float] | list[list[float]]) -> FloatArray:
    """From um to m."""
    return np.asarray(values, dtype=float) * UM


def _quantile(content: Json, torques: int) -> Quantile:
    """One quantile; a bound that the sample is too small for was left out."""
    ends = (
        np.full(torques, unbounded) if content[name] is None else _lengths(content[name])
        for name, unbounded in (("low_um", 0.0), ("high_um", math.inf))
    )
    low, high = ends
    return Quantile(content["fraction"], _lengths(content["value_um"]), low, high)
