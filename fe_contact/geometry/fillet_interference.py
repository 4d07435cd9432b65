"""Interference of a tip edge with the mating fillet, off the line of action."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fe_contact.geometry.parallel_axes import ParallelAxes
    from fe_contact.geometry.toothing import Toothing

_SAMPLES = 513


def fillet_penetration(pair: ParallelAxes, tip: Toothing, flank: Toothing) -> float:
    """Depth in m (arc) to which the edge of `tip` cuts the fillet of `flank`, both external; 0 if clear.

    The gears turn in conjugate motion. The edge is followed on both sides of the line of centers, from where
    it crosses the line of action; its path in the mate's frame is compared with the fillet at equal radius.
    """
    opening = math.atan2(tip.tip_roll_length, tip.base_radius)
    widest = abs(pair.working_pressure_angle - opening)
    polar = np.linspace(-widest, widest, _SAMPLES)  # of the edge, from the line of centers
    x = pair.center_distance - tip.tip_radius * np.cos(polar)
    y = -tip.tip_radius * np.sin(polar)
    roll_length = tip.tip_roll_length - tip.base_radius * (polar + opening - pair.working_pressure_angle)
    turned = (pair.common_tangent - roll_length) / flank.base_radius
    edge = pair.working_pressure_angle - turned + flank.base_thickness_half_angle - np.arctan2(y, x)
    radius = np.hypot(x, y)
    tool_angle = np.linspace(0.5 * math.pi, flank.form_point.tool_angle, _SAMPLES)
    fillet_radius = flank.trochoid.radius(tool_angle)
    fillet = np.interp(radius, fillet_radius, flank.trochoid.polar_angle(tool_angle))
    below_form = radius < flank.form_radius
    return float(np.max(radius * (fillet - edge), initial=0.0, where=below_form))
