"""Mean and peak-to-peak transmission error as expected before anything is computed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.allowed_error import RELATIVE, AllowedError
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.discretization import FaceDiscretization
from fe_contact.planning.model_error import helical_share
from fe_contact.planning.plan import Plan
from fe_contact.types import FloatArray

_PLANE_RIPPLE, _SPUR_RIPPLE, _HELICAL_RIPPLE = 0.4, 0.4, 0.15
"""Peak-to-peak over mean of usual pairs: in the plane, over the face of spur and of helical pairs."""

PLANE = {
    "draft": (8e-4, 1.2e-3),
    "medium": (4.6e-4, 5.6e-4),
    "standard": (2.6e-4, 2.6e-4),
    "fine": (5.4e-5, 5e-5),
}

SPUR = {
    "draft": (2.2e-3, 1.1e-3),
    "medium": (1.6e-3, 8.1e-4),
    "standard": (1.1e-3, 6e-4),
    "fine": (4.6e-4, 4.6e-4),
}

HELICAL = {
    "draft": (5e-3, 3e-3),
    "medium": (3e-3, 1.6e-3),
    "standard": (1.8e-3, 8.5e-4),
    "fine": (8e-4, 4e-4),
}

RELIEVED = {
    "draft": (4e-3, 1.8e-3),
    "medium": (2.5e-3, 9e-4),
    "standard": (1.6e-3, 4.5e-4),
    "fine": (6e-4, 2.3e-4),
}
"""Errors of mean and of peak-to-peak by the mesh of a level, over the mean's rise under load. `PLANE` is for
the plane, `SPUR` for spur pairs over the face, `HELICAL` and `RELIEVED` for helical pairs with plain and with
modified profiles. Contact lines of modified profiles end under less load.
"""

QUIET = {
    "draft": (1.4e-3, 9.8e-4),
    "medium": (1.4e-3, 5.2e-4),
    "standard": (5e-4, 2.5e-4),
    "fine": (4e-4, 2e-4),
}
"""Errors of mean and of peak-to-peak of helical pairs whose gears are both relieved (`is_relieved_helical`).
They are over the product of the mean's rise under load and the part of the change to the coarse mesh that
second order leaves, and are medians of drawn pairs.
"""

QUIET_SCATTER = 0.3
"""Standard deviation of the logarithm of the stated over the expected error of these pairs."""

HELICAL_SLICES, QUIET_SLICES, SPUR_SLICES = 7e-4, 3e-4, 5e-5
SLICES = 15
"""Errors of peak-to-peak with `SLICES` slices over the mean's rise; helical: times the overlap ratio."""

WIDTH_RIPPLE = 0.45
"""Peak-to-peak over mean of usual spur pairs."""

PLANE_POSITIONS, FACE_POSITIONS = 0.14, 0.55
"""Error of peak-to-peak between positions over the allowed error of their search."""


@dataclass(frozen=True)
class ExpectedCurves:
    """Mean and peak-to-peak STE of some curves of a table."""

    force: FloatArray
    """Normal force, N. Shape (C,)."""
    added: FloatArray
    """Rise of the mean under load, m. Shape (C,)."""
    mean: FloatArray
    peak_to_peak: FloatArray
    """`mean`, `peak_to_peak`: Expected mean and peak-to-peak STE, m. Shape (C,) each."""
    allowed: AllowedError
    """Allowed error, which sets the size below which errors count absolutely."""
    absolute: bool = True
    """Whether mean and peak-to-peak are sizes of the case; False: parts of its mean, as for usual pairs."""

    @property
    def scale(self) -> FloatArray:
        """Sizes (2, C) of which errors of mean and peak-to-peak are parts, m."""
        return self.allowed.scale(np.stack([self.mean, self.peak_to_peak]))


def usual_curves(pair: ParallelAxes, plan: Plan) -> ExpectedCurves:
    """Return the curves of usual pairs, whose mean is 1."""
    unity = np.ones(plan.load.size)
    across_face = isinstance(plan.discretization, FaceDiscretization)
    spur = _SPUR_RIPPLE if across_face else _PLANE_RIPPLE
    ripple = spur + helical_share(pair) * (_HELICAL_RIPPLE - spur)
    return ExpectedCurves(plan.load, unity, unity, ripple * unity, RELATIVE, absolute=False)
