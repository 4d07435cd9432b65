"""Slices of the common face width, and the points of the contact line within them.

Loads press on the bodies slice by slice; where the flanks touch and with what line load is found at points,
several a slice. What the bodies move is known as the mean over each slice; at the points it is the smooth
curve with these means. The forces of the points act on the slices by the same weights, so that forces and
their moments over the face are kept, and action is reaction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray

POINTS = 6
"""Points of a slice: ten change the ripple of helical pairs by 1 to 2 nm at most."""


@dataclass(frozen=True)
class Slices:
    """Slices of equal width over the common face width.

    Attributes
    ----------
    center : ndarray, shape (K,)
        Distance of the middle of each slice from the pinion's mid-face, m.
    width : float
        Along the face, m.
    points : int
        Of the contact line in each slice.
    """

    center: FloatArray
    width: float
    points: int = 1

    @classmethod
    def of_pair(cls, pair: ParallelAxes, count: int, points: int | None = None) -> Slices:
        """Divide the common face width of `pair` into `count` slices; one slice is the plane model."""
        width = pair.face_width / count
        center = pair.common_face_center + (np.arange(count) - 0.5 * (count - 1)) * width
        return cls(np.asarray(center, dtype=float), width, points or (1 if count == 1 else POINTS))

    @property
    def point_width(self) -> float:
        """Part of the face that a point stands for, m."""
        return self.width / self.points

    @property
    def point_center(self) -> FloatArray:
        """Distance of the points (K Q,) from the pinion's mid-face, m."""
        within = (np.arange(self.points) - 0.5 * (self.points - 1)) * self.point_width
        return np.asarray((self.center[:, None] + within).ravel())

    @property
    def blend(self) -> FloatArray:
        """Contribution of the mean motions of the slices at each point, (K Q, K).

        The derivative of the cubic spline through the sums of the slices before each: smooth over the face,
        with the means of the slices as they are.
        """
        count = self.center.size
        ends = np.arange(count + 1.0)
        sums = np.tril(np.ones((count + 1, count)), -1)
        at = (self.point_center - self.center[0]) / self.width + 0.5
        return np.asarray(CubicSpline(ends, sums)(at, 1))
