"""Slices of the common face width, and the points of the contact line within them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray

POINTS = 6
"""Points of a slice: ten change the ripple of helical pairs by 1 to 2 nm at most."""


@dataclass(frozen=True)
class Slices:
    """Slices of equal width over the common face width."""

    center: FloatArray
    """Distance of the middle of each slice from the pinion's mid-face, m. Shape (K,)."""
    width: float
    """Width of a slice along the face, m."""
    points: int = 1
    """Number of points of the contact line in each slice."""

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
    def curves(self) -> tuple[FloatArray, FloatArray]:
        """Curves over the face at each point (K Q, K), and their heights (K, K) for mean motions of slices.

        Their sum is the derivative of the cubic spline through the sums of the slices before each: smooth
        over the face, with the means of the slices as they are. At a point at most three are not zero.
        """
        count = self.center.size
        degree, knots = min(count - 1, 2), np.arange(count + 1.0)
        knots = np.concatenate([np.zeros(degree + 1), knots[2:-2], np.full(degree + 1, float(count))])
        at = (self.point_center - self.center[0]) / self.width + 0.5
        within = np.arange(count)[:, None] + 0.5 + np.array([-1.0, 1.0]) / math.sqrt(12.0)  # Gauss points
        curves, means = (basis_splines(x, knots, degree) for x in (at, within.ravel()))
        return curves, np.linalg.inv(means.reshape(count, 2, count).mean(axis=1))


def basis_splines(at: FloatArray, knots: FloatArray, degree: int) -> FloatArray:
    """Return the basis splines of some degree at coordinates: (N,) and (S + degree + 1,) to (N, S).

    De Boor's recurrence over the degree, with the order of terms of scipy.interpolate, which gives the same
    bits: loading that takes a tenth of a first table of a plane pair.
    """
    count, rows = knots.size - degree - 1, np.arange(at.size)
    interval = np.clip(np.searchsorted(knots, at, side="right") - 1, degree, count - 1)
    values = [np.ones(at.size)]
    for j in range(1, degree + 1):
        raised = [np.zeros(at.size)]
        for n, lower in enumerate(values, 1):
            left, right = knots[interval + n - j], knots[interval + n]
            weight = lower / (right - left)
            raised[-1] = raised[-1] + weight * (right - at)
            raised.append(weight * (at - left))
        values = raised
    splines = np.zeros((at.size, count))
    for n, value in enumerate(values):
        splines[rows, interval - degree + n] = value
    return splines
