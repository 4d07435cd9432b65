"""Mean and peak-to-peak transmission error as expected before anything is computed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.allowed_error import RELATIVE, AllowedError
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.discretization import FaceDiscretization
from fe_contact.planning.plan import Plan
from fe_contact.types import FloatArray

_PLANE_RIPPLE, _SPUR_RIPPLE, _HELICAL_RIPPLE = 0.4, 0.4, 0.15
"""Peak-to-peak over mean of usual pairs: in the plane, over the face of spur and of helical pairs."""


@dataclass(frozen=True)
class ExpectedCurves:
    """Mean and peak-to-peak STE of some curves of a table.

    Attributes
    ----------
    force : ndarray, shape (C,)
        Normal force, N.
    added : ndarray, shape (C,)
        Mean less that at no load, m.
    mean, peak_to_peak : ndarray, shape (C,)
        m.
    allowed : AllowedError
        Says below which size errors count absolutely.
    absolute : bool
        Whether these are sizes of the case; False: parts of its mean, as usual pairs have them.
    """

    force: FloatArray
    added: FloatArray
    mean: FloatArray
    peak_to_peak: FloatArray
    allowed: AllowedError
    absolute: bool = True

    @property
    def scale(self) -> FloatArray:
        """Sizes (2, C) of which errors of mean and peak-to-peak are parts, m."""
        return self.allowed.scale(np.stack([self.mean, self.peak_to_peak]))


def usual_curves(pair: ParallelAxes, plan: Plan) -> ExpectedCurves:
    """Return those of usual pairs, whose mean is 1."""
    unity = np.ones(plan.load.size)
    across_face = isinstance(plan.discretization, FaceDiscretization)
    spur = _SPUR_RIPPLE if across_face else _PLANE_RIPPLE
    ripple = _HELICAL_RIPPLE if pair.base_helix_angle else spur
    return ExpectedCurves(plan.load, unity, unity, ripple * unity, RELATIVE, absolute=False)
