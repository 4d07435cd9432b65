"""Correction from a plane model to the gears of finite width: a bias of known sign, with its uncertainty."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bounds import engineering
from fe_contact.types import Estimate, FloatArray, Json

BIAS_ERROR = 0.2
"""Relative error of the bias (`finite_width_excess`)."""
_VISIBLE = 0.8
"""Share of the peak-to-peak of unmodified flanks above which reliefs do not hide the bending of teeth."""
_UM = 1e-6


@dataclass(frozen=True)
class PlaneBias:
    """Bias of a plane model: excess of the STE of the gears over that of the plane, within stated errors."""

    subject: str
    """Plane model and face width, in words."""
    mean: float
    peak_to_peak: float
    """`mean`, `peak_to_peak`: Excess over the values in the plane, relative to them; negative: the plane
    deflects more. `peak_to_peak` is that of flanks whose ripple no relief hides.
    """
    bending_ripple: float
    """Peak-to-peak over the mean of unmodified flanks."""
    hidden: float = 0.0
    """Largest change of peak-to-peak to either side, m, of curves whose ripple reliefs hide; 0 where they
    hide nothing.
    """

    def correction(self, mean: FloatArray, peak_to_peak: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the correction of mean and peak-to-peak (...) in the plane, and its error, (2, ...) in m.

        Teeth that bend more change a ripple that reliefs hide by as much as another ripple, but with either
        sign. Nothing is added to a hidden ripple, and its error is the whole change.
        """
        bending = self.bending_ripple * mean
        shows = peak_to_peak >= _VISIBLE * bending
        ripple = abs(self.peak_to_peak) * np.maximum(peak_to_peak, bending)
        added = np.stack([self.mean * mean, np.where(shows, self.peak_to_peak * peak_to_peak, 0.0)])
        ripple_error = np.where(shows, BIAS_ERROR, 1.0 + BIAS_ERROR) * ripple
        return added, np.stack([BIAS_ERROR * np.abs(added[0]), ripple_error])

    def largest(self, mean: FloatArray, peak_to_peak: FloatArray) -> FloatArray:
        """Return the largest deviation of a plane that is not corrected, (2, ...) in m."""
        added, error = self.correction(mean, peak_to_peak)
        return np.asarray(np.abs(added) + error)

    def of_curves(self, mean: FloatArray, peak_to_peak: FloatArray) -> PlaneBias:
        """Return the bias with its hidden part in curves (...), m; curves with NaN are left out."""
        added, error = self.correction(mean, peak_to_peak)
        hidden = (added[1] == 0.0) & np.isfinite(error[1])
        return replace(self, hidden=float(np.max(error[1], where=hidden, initial=0.0)))

    @property
    def text(self) -> str:
        """Bias in one sentence."""
        ripple = _percent(self.peak_to_peak)
        if self.hidden:
            ripple = f"by up to {engineering(self.hidden / _UM, 2)} µm, either way"
        return (
            f"bias of {self.subject} mean {_percent(self.mean)}, peak-to-peak {ripple}, "
            f"not in the errors; compute it with model auto and effect finite_width on"
        )

    def to_json(self) -> Json:
        """Return plain JSON; `peak_to_peak` is None where reliefs hide it."""
        return {
            "subject": self.subject,
            "mean": self.mean,
            "peak_to_peak": None if self.hidden else self.peak_to_peak,
            "visible_peak_to_peak": self.peak_to_peak,
            "bending_ripple": self.bending_ripple,
            "either_way_m": self.hidden,
            "error": BIAS_ERROR,
            "words": self.text,
        }

    @classmethod
    def from_json(cls, content: Json) -> PlaneBias:
        """Return the bias that a receipt states."""
        return cls(
            content["subject"],
            content["mean"],
            content["visible_peak_to_peak"],
            content["bending_ripple"],
            content["either_way_m"],
        )


def stored_bias(receipt: Json) -> PlaneBias | None:
    """Return the bias of a receipt; None where the table has none, or is older than its correction."""
    content = receipt.get("bias") or {}
    return PlaneBias.from_json(content) if "visible_peak_to_peak" in content else None


@dataclass(frozen=True)
class OverFace:
    """Mean and peak-to-peak of the gears of finite width, from those in the plane and their correction.

    Errors, m, are those of the plane's solution and of the correction together.
    """

    mean: Estimate
    peak_to_peak: Estimate


def over_face(bias: PlaneBias, mean: Estimate, peak_to_peak: Estimate) -> OverFace:
    """Return mean and peak-to-peak of the gears from a plane solution; the two errors are independent."""
    added, errors = bias.correction(np.array(mean.value), np.array(peak_to_peak.value))
    return OverFace(
        *(
            Estimate(plane.value + float(more), float(np.hypot(plane.error, error)), plane.unit)
            for plane, more, error in zip((mean, peak_to_peak), added, errors, strict=True)
        )
    )


def _percent(bias: float) -> str:
    error = engineering(100.0 * BIAS_ERROR * abs(bias), 2)
    return f"{'-' if bias < 0.0 else '+'}{engineering(100.0 * abs(bias), 2)} % ({error} %)"
