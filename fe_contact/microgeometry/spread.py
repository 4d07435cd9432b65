"""Quantiles of a sample with confidence bounds that assume no shape of the distribution."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fe_contact.types import FloatArray, Json
from model_studies import in_unit
from model_studies.spread import quantile_bounds


@dataclass(frozen=True)
class Quantile:
    """A quantile of peak-to-peak at each of L torques.

    Attributes
    ----------
    fraction : float
        Part of all pairs that lie below.
    value, low, high : ndarray, shape (L,)
        Estimate and confidence bounds, m; infinite or zero where the sample is too small for a bound.
    """

    fraction: float
    value: FloatArray = field(metadata=in_unit("m", "torque"))
    low: FloatArray = field(metadata=in_unit("m", "torque"))
    high: FloatArray = field(metadata=in_unit("m", "torque"))

    def to_json(self) -> Json:
        """Return plain JSON; a bound that the sample is too small for is null."""
        return {
            "fraction": self.fraction,
            "value_m": self.value.tolist(),
            "low_m": self.low.tolist() if self.low.any() else None,
            "high_m": self.high.tolist() if np.isfinite(self.high).all() else None,
        }


def quantile(sample: FloatArray, fraction: float, confidence: float) -> Quantile:
    """Estimate a quantile of samples (N, L) of lengths with distribution-free bounds."""
    value, low, high = quantile_bounds(sample, fraction, confidence)
    return Quantile(fraction, value, np.maximum(low, 0.0), high)
