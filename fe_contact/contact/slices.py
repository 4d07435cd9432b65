"""Slices of the common face width, and the points of the contact line within them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray

POINTS = 6
"""Points of a slice. With ten the ripple of helical pairs differs by 1 to 2 nm at most."""


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
        """Divide the common face width of `pair` into `count` slices; one slice gives the plane model."""
        width = pair.face_width / count
        center = pair.common_face_center + (np.arange(count) - 0.5 * (count - 1)) * width
        return cls(np.asarray(center, dtype=float), width, points or (1 if count == 1 else POINTS))

    @property
    def point_width(self) -> float:
        """Width of the face that each point represents, m."""
        return self.width / self.points

    @property
    def point_center(self) -> FloatArray:
        """Distance of the points (K Q,) from the pinion's mid-face, m."""
        from_center = (np.arange(self.points) - 0.5 * (self.points - 1)) * self.point_width
        return np.asarray((self.center[:, None] + from_center).ravel())

    @property
    def curves(self) -> tuple[FloatArray, FloatArray]:
        """Curves over the face at each point (K Q, K), and their heights (K, K) for mean motions of slices.

        The curves times the heights make a quadratic spline over the face. Its mean over a slice is the mean
        motion of that slice. It is the derivative of a cubic not-a-knot spline, which passes through the sum
        of the means of the preceding slices at each boundary. At most three curves are not zero at a point.
        """
        count = self.center.size
        degree, ends = min(count - 1, 2), np.arange(count + 1.0)
        # not a knot: the inner boundaries next to the ends of the face are left out
        knots = np.concatenate([np.zeros(degree + 1), ends[2:-2], np.full(degree + 1, float(count))])
        position = (self.point_center - self.center[0]) / self.width + 0.5
        gauss_points = np.arange(count)[:, None] + 0.5 + np.array([-1.0, 1.0]) / math.sqrt(12.0)
        curves, means = (basis_splines(x, knots, degree) for x in (position, gauss_points.ravel()))
        return curves, np.linalg.inv(means.reshape(count, 2, count).mean(axis=1))


def basis_splines(coordinate: FloatArray, knots: FloatArray, degree: int) -> FloatArray:
    """Return the S basis splines (N, S) of a degree at coordinates (N,), with S + degree + 1 knots.

    This is De Boor's recurrence over the degree, with the terms in the order of scipy.interpolate, so that
    the results are bitwise the same. To load scipy.interpolate would take a tenth of the time of a first
    table of a plane pair.
    """
    count, rows = knots.size - degree - 1, np.arange(coordinate.size)
    interval = np.clip(np.searchsorted(knots, coordinate, side="right") - 1, degree, count - 1)
    values = [np.ones(coordinate.size)]
    for j in range(1, degree + 1):
        raised = [np.zeros(coordinate.size)]
        for n, lower in enumerate(values, 1):
            left, right = knots[interval + n - j], knots[interval + n]
            weight = lower / (right - left)
            raised[-1] = raised[-1] + weight * (right - coordinate)
            raised.append(weight * (coordinate - left))
        values = raised
    splines = np.zeros((coordinate.size, count))
    for n, value in enumerate(values):
        splines[rows, interval - degree + n] = value
    return splines
