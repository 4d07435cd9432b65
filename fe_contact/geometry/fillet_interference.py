"""Interference of a tip edge with the mating fillet, off the line of action."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fe_contact.flank.modification import UNMODIFIED

if TYPE_CHECKING:
    from fe_contact.geometry.parallel_axes import ParallelAxes
    from fe_contact.geometry.toothing import Toothing


_SAMPLES = 513

FILLET_SLACK = 1e-6  # of the normal module: the resolution of the sampled tip path

_HALVINGS = 40  # of the range in which the largest clear tip radius is searched


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


def largest_clear_tip(pair: ParallelAxes, gear: Toothing, mate: Toothing) -> float | None:
    """Return the largest tip diameter in m that interferes nowhere, None if even the form diameter does."""
    reach = max(pair.common_tangent - mate.form_roll_length, 0.0)
    low, high = gear.form_radius, min(gear.tip_radius, math.hypot(gear.base_radius, reach))

    def cuts(radius: float) -> bool:
        tip_diameter = 2.0 * radius
        shorter = replace(gear, tip_diameter=tip_diameter, modification=UNMODIFIED)
        return fillet_penetration(pair, shorter, mate) > FILLET_SLACK * gear.normal_module

    low += 1e-6 * gear.normal_module
    if high <= low or cuts(low):
        return None
    if not cuts(high):
        return 2.0 * high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if cuts(middle) else (middle, high)
    return 2.0 * low
