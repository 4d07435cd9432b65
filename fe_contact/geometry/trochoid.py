"""The tooth root fillet: envelope of the rack tool's tip rounding (a trochoid's equidistant).

The tool's rounding is a circle in the normal plane. Seen in the transverse plane, where the generation takes
place, it is an ellipse: distances along the pitch line grow by 1/cos(beta), heights do not. Its points are
named by `tool_angle` theta: the angle between their normal and the pitch line in the normal plane, from the
pressure angle (where the rounding leaves the straight flank) to pi/2 (the tool's tip, which generates the
root circle). Every rack point generates the gear point at which its normal passes through the pitch point
(law of gearing).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.geometry.fillet_curve import FilletCurve
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class Trochoid(FilletCurve):
    """Fillet of the right flank, in the tooth frame."""

    reference_radius: float
    """Radius in m of the circle that rolls on the tool's pitch line."""
    corner_distance: float
    """Transverse distance in m along the pitch line from the tooth's center line to the rounding's center."""
    corner_height: float
    """Height in m of the rounding's center above the pitch line (usually negative)."""
    corner_radius: float
    """Radius rho_fP of the rounding in the normal plane, m."""
    helix_angle: float
    """beta in rad."""

    @property
    def root_angle(self) -> float:
        """Angle from the tooth's center line to the fillet's end on the root circle, rad."""
        return self.corner_distance / self.reference_radius

    def height(self, tool_angle: FloatArray) -> FloatArray:
        """Height of the tool's points above the pitch line, m."""
        return self.corner_height - self.corner_radius * np.sin(tool_angle)

    def _normal_slope(self, tool_angle: FloatArray) -> FloatArray:
        return math.cos(self.helix_angle) * np.cos(tool_angle) / np.sin(tool_angle)

    def _rotation(self, tool_angle: FloatArray) -> FloatArray:
        """Angle by which the gear has rolled when the point is generated, rad."""
        distance = self.corner_distance - self.corner_radius * np.cos(tool_angle) / math.cos(self.helix_angle)
        return (distance - self.height(tool_angle) * self._normal_slope(tool_angle)) / self.reference_radius

    def point(self, tool_angle: FloatArray) -> FloatArray:
        """Points (n, 2) in m."""
        height = self.height(tool_angle)
        x, y = height * self._normal_slope(tool_angle), self.reference_radius + height
        return turned_clockwise(x, y, self._rotation(tool_angle))

    def normal(self, tool_angle: FloatArray) -> FloatArray:
        """Outward unit normals (n, 2)."""
        slope = self._normal_slope(tool_angle)
        length = np.hypot(slope, 1.0)
        return turned_clockwise(slope / length, 1.0 / length, self._rotation(tool_angle))

    def radius(self, tool_angle: FloatArray) -> FloatArray:
        """Distance from the gear's center, m; falls monotonically with the tool angle."""
        height = self.height(tool_angle)
        return np.hypot(height * self._normal_slope(tool_angle), self.reference_radius + height)

    def polar_angle(self, tool_angle: FloatArray) -> FloatArray:
        """Angle from the tooth's center line, rad; positive on the right flank's side."""
        height = self.height(tool_angle)
        offset = np.arctan2(height * self._normal_slope(tool_angle), self.reference_radius + height)
        return self._rotation(tool_angle) + offset

    def speed(self, tool_angle: FloatArray) -> FloatArray:
        """Arc length per tool angle, m/rad.

        The tool's own arc plus the sliding between tool and gear, which is the distance to the pitch point
        times the gear's rotation.
        """
        sine, cosine, ratio = np.sin(tool_angle), np.cos(tool_angle), math.cos(self.helix_angle)
        height, radius = self.height(tool_angle), self.corner_radius
        along = radius * sine / ratio
        rolled = along + radius * cosine * self._normal_slope(tool_angle) + height * ratio / sine**2
        tangential = along + height * rolled / self.reference_radius
        return np.asarray(tangential * np.hypot(self._normal_slope(tool_angle), 1.0), dtype=float)


def turned_clockwise(x: FloatArray, y: FloatArray, angle: FloatArray) -> FloatArray:
    """Turn vectors (x, y) clockwise by `angle`."""
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.stack((x * cosine + y * sine, y * cosine - x * sine), axis=-1)
