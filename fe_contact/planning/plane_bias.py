"""What a plane model leaves out of gears of finite width: a bias of known sign, stated beside the errors."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bounds import engineering
from fe_contact.compliance import PlaneHypothesis
from fe_contact.geometry import ParallelAxes
from fe_contact.geometry.web_compliance import finite_width_excess, plane_stress_excess
from fe_contact.planning.model_error import of_bending
from fe_contact.planning.plan import Discretization, FaceDiscretization
from fe_contact.ste.curve_quantities import MEAN, PEAK_TO_PEAK
from fe_contact.types import FloatArray, Json

LEFT_OUT = 1.25
"""Stated error over the bias as estimated."""
BIAS_ERROR = 0.2
"""Error of that estimate in parts of it (`finite_width_excess`)."""
_SHOWN = 0.8
"""Part of the peak-to-peak of unmodified flanks from which reliefs do not hide it."""
_UM, _MM = 1e-6, 1e-3


@dataclass(frozen=True)
class PlaneBias:
    """By how much the STE of the gears exceeds that of a plane model; it is no error of the solution.

    Attributes
    ----------
    model : str
        In words.
    face_width : float
        m.
    mean, peak_to_peak : float
        In parts of those in the plane; negative: the plane deflects more. `peak_to_peak` is that of usual
        flanks.
    hidden : float
        Where reliefs hide what teeth bend, its peak-to-peak may change to either side, by so much at most, m;
        0 where they hide nothing.
    """

    model: str
    face_width: float
    mean: float
    peak_to_peak: float
    hidden: float = 0.0

    @classmethod
    def of(cls, pair: ParallelAxes, made: Discretization) -> PlaneBias | None:
        """Return that of usual flanks; None in three dimensions and in a plane that is corrected."""
        if isinstance(made, FaceDiscretization) or made.corrected:
            return None
        if made.hypothesis is PlaneHypothesis.PLANE_STRESS:
            mean, ripple = (1.0 / (1.0 + excess) - 1.0 for excess in plane_stress_excess(pair))
        else:
            mean, ripple = finite_width_excess(pair)
        return cls(made.hypothesis.value.replace("_", " "), pair.face_width, mean, ripple)

    def errors(self, pair: ParallelAxes, own: FloatArray) -> FloatArray:
        """Return the errors of the quantities `own` (Q, ...) in m where nothing corrects it."""
        parts = np.full(len(own), LEFT_OUT * abs(self.peak_to_peak))
        parts[MEAN] = LEFT_OUT * abs(self.mean)
        return np.asarray(parts.reshape(-1, *[1] * (own.ndim - 1)) * of_bending(pair, own))

    def of_curves(self, pair: ParallelAxes, own: FloatArray) -> PlaneBias:
        """Return that of curves whose mean and peak-to-peak are `own` (2, ...), m."""
        less = own[PEAK_TO_PEAK] < _SHOWN * of_bending(pair, own)[PEAK_TO_PEAK]
        hidden = np.max(self.errors(pair, own)[PEAK_TO_PEAK], where=less, initial=0.0)
        return replace(self, hidden=float(hidden))

    @property
    def words(self) -> str:
        """In one sentence."""
        ripple = _part(self.peak_to_peak)
        if self.hidden:
            ripple = f"by up to {engineering(self.hidden / _UM, 2)} µm, either way"
        return (
            f"bias of {self.model}: over the face of {self.face_width / _MM:.4g} mm mean {_part(self.mean)}, "
            f"peak-to-peak {ripple}, not in the errors; compute it with model auto and effect finite_width on"
        )

    def to_json(self) -> Json:
        """Return plain JSON; `stated`: the part of the transmission error by which bands are wider for it."""
        return {
            "mean": self.mean,
            "peak_to_peak": None if self.hidden else self.peak_to_peak,
            "either_way_m": self.hidden,
            "error": BIAS_ERROR,
            "stated": LEFT_OUT * abs(self.mean),
            "words": self.words,
        }


def _part(bias: float) -> str:
    error = engineering(100.0 * BIAS_ERROR * abs(bias), 2)
    return f"{'-' if bias < 0.0 else '+'}{engineering(100.0 * abs(bias), 2)} % ({error} %)"
