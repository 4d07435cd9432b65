"""The pinion-type cutter (shaper cutter) that generates an internal gear."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class PinionCutter:
    """An external involute toothing with rounded tips, rolling inside the gear without backlash."""

    teeth: int
    """z_0."""
    base_radius: float
    base_half_angle: float
    """`base_radius`, `base_half_angle`: Base radius in m, and half the cutter tooth's angle there, rad."""
    tip_radius: float
    """d_a0 / 2 in m."""
    corner_radius: float
    """rho_a0: radius of the tip rounding in the transverse plane, m."""
    center_distance: float
    """Distance a_0 in m of the cutter's axis from the gear's at full depth."""
    ratio: float
    """z_0 / z: turn of the gear per turn of the cutter."""

    @property
    def working_pressure_angle(self) -> float:
        """Pressure angle of the generation alpha_w0, rad."""
        return math.acos(self.base_radius * (1.0 / self.ratio - 1.0) / self.center_distance)

    @property
    def pitch_radius(self) -> float:
        """Radius of the cutter's circle that rolls on the gear's, m."""
        return self.center_distance / (1.0 / self.ratio - 1.0)

    @property
    def common_tangent(self) -> float:
        """a_0 sin(alpha_w0) in m: the gear's roll length less the cutter's."""
        return self.center_distance * math.sin(self.working_pressure_angle)

    @property
    def corner_center_radius(self) -> float:
        """Distance of the rounding's center from the cutter's axis, m."""
        return self.tip_radius - self.corner_radius

    @property
    def corner_roll_length(self) -> float:
        """Roll length of the rounding's center, which lies on the flank's equidistant, m."""
        return math.sqrt(max(self.corner_center_radius**2 - self.base_radius**2, 0.0))

    @property
    def flank_end_roll_length(self) -> float:
        """Roll length at which the rounding touches the cutter's involute, m."""
        return self.corner_roll_length + self.corner_radius

    @property
    def first_tool_angle(self) -> float:
        """Tool angle at which the rounding leaves the involute, rad (see `CutterTrochoid`)."""
        return math.atan2(self.corner_roll_length, self.base_radius)

    @property
    def corner_angle(self) -> float:
        """Angle from the cutter tooth's center line to the rounding's center, rad; < 0 does not fit."""
        foot = self.base_half_angle - self.flank_end_roll_length / self.base_radius
        return foot + self.first_tool_angle
