"""The tooth root fillet of an internal gear: envelope of a pinion cutter's tip rounding.

The tool angle names a point of the rounding, as in `trochoid`: pi/2 is the cutter's tip. The crossing is the
point in which the normal of the rounding at that point meets the cutter's pitch circle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.geometry.fillet_curve import FilletCurve
from fe_contact.geometry.pinion_cutter import PinionCutter
from fe_contact.geometry.trochoid import turned_clockwise
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class CutterTrochoid(FilletCurve):
    """Fillet of the right flank of a ring gear, in the tooth frame."""

    cutter: PinionCutter
    """The tool and its place in the gear."""
    half_pitch_angle: float
    """pi / z of the gear, rad: from its tooth's center line to that of the tooth space."""

    @property
    def root_angle(self) -> float:
        """Angle from the tooth's center line to the fillet's end on the root circle, rad."""
        return self.half_pitch_angle - self.cutter.corner_angle * self.cutter.ratio

    def _reach(self, tool_angle: FloatArray) -> FloatArray:
        """Distance of the crossing along the normal from the foot of the cutter's axis on it, m, >= 0."""
        across = self.cutter.corner_center_radius * np.cos(tool_angle)
        return np.asarray(np.sqrt(self.cutter.pitch_radius**2 - across**2), dtype=float)

    def _crossing(self, tool_angle: FloatArray) -> FloatArray:
        """Distance q of the crossing along the normal from the rounding's center, m."""
        return self._reach(tool_angle) - self.cutter.corner_center_radius * np.sin(tool_angle)

    def _crossing_angle(self, tool_angle: FloatArray) -> FloatArray:
        """Polar angle of the crossing on the cutter, from the rounding's center, rad."""
        crossing = self._crossing(tool_angle)
        along = self.cutter.corner_center_radius + crossing * np.sin(tool_angle)
        return np.asarray(np.arctan2(crossing * np.cos(tool_angle), along), dtype=float)

    def _to_tooth(self, x: FloatArray, y: FloatArray, tool_angle: FloatArray) -> FloatArray:
        """Vectors of the frame of centers at the generating position, in the tooth frame.

        The gear has turned with the cutter; the space's center line lies half a pitch from the tooth's, and
        the right flank of the tooth is the left one of the space: hence the mirror.
        """
        turned = (self.cutter.corner_angle + self._crossing_angle(tool_angle)) * self.cutter.ratio
        in_space = turned_clockwise(x, y, turned)
        angle = np.full(np.shape(tool_angle), self.half_pitch_angle)
        return turned_clockwise(-in_space[..., 0], in_space[..., 1], angle)

    def point(self, tool_angle: FloatArray) -> FloatArray:
        """Points (n, 2) in m."""
        angle, rounding = np.asarray(tool_angle, dtype=float), self.cutter.corner_radius
        along = self.cutter.corner_center_radius + rounding * np.sin(angle)
        tool = turned_clockwise(rounding * np.cos(angle), along, -self._crossing_angle(angle))
        return self._to_tooth(tool[..., 0], tool[..., 1] + self.cutter.center_distance, angle)

    def normal(self, tool_angle: FloatArray) -> FloatArray:
        """Outward unit normals (n, 2): out of the gear, into the tool."""
        angle = np.asarray(tool_angle, dtype=float)
        tool = turned_clockwise(-np.cos(angle), -np.sin(angle), -self._crossing_angle(angle))
        return self._to_tooth(tool[..., 0], tool[..., 1], angle)

    def radius(self, tool_angle: FloatArray) -> FloatArray:
        """Distance from the gear's center, m; grows monotonically with the tool angle."""
        return np.asarray(np.hypot(*np.moveaxis(self.point(tool_angle), -1, 0)), dtype=float)

    def polar_angle(self, tool_angle: FloatArray) -> FloatArray:
        """Angle from the tooth's center line, rad; positive on the right flank's side."""
        x, y = np.moveaxis(self.point(tool_angle), -1, 0)
        return np.asarray(np.arctan2(x, y), dtype=float)

    def speed(self, tool_angle: FloatArray) -> FloatArray:
        """Arc length per tool angle, m/rad.

        The tool's own arc plus the sliding between tool and gear: the distance from the pitch point times
        the rotation of the tool relative to the gear.
        """
        rounding, crossing = self.cutter.corner_radius, self._crossing(tool_angle)
        rotation = crossing / self._reach(tool_angle) * (1.0 - self.cutter.ratio)
        return np.asarray(rounding - (rounding - crossing) * rotation, dtype=float)
