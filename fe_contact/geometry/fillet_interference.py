"""Interference of a tip edge with the mating fillet, off the line of action.

The path of the tip edge is drawn in the frame of the mate and compared with the mate's fillet there. The
largest tip diameter whose path stays clear is found by bisection.
"""

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
"""Points of the tip path, and points of the fillet."""
FILLET_SLACK = 1e-6
"""Penetration that counts as clear, as a share of the normal module: the resolution of the sampled path."""
_HALVINGS = 40
"""Bisection steps in the search for the largest clear tip radius."""
_ABOVE_FORM = 1e-6
"""Distance of the smallest tip radius that is tried from the form radius, as a share of the normal module."""


def fillet_penetration(pair: ParallelAxes, tip: Toothing, flank: Toothing) -> float:
    """Return the depth in m (arc) to which the edge of `tip` cuts the fillet of `flank`; 0 if it is clear.

    Both gears are external and turn in conjugate motion. The edge is followed on both sides of the line of
    centers, from where it crosses the line of action; its path in the mate's frame is compared with the
    fillet at equal radius.
    """
    tip_pressure_angle = math.atan2(tip.tip_roll_length, tip.base_radius)
    largest_angle = abs(pair.working_pressure_angle - tip_pressure_angle)
    polar = np.linspace(-largest_angle, largest_angle, _SAMPLES)  # of the edge, from the line of centers
    # The edge in the fixed plane, from the center of the mate.
    x = pair.center_distance - tip.tip_radius * np.cos(polar)
    y = -tip.tip_radius * np.sin(polar)
    # The rotation that brings the edge to `polar` moves the conjugate contact point along the line of action,
    # here by its roll length on `tip`; the mate turns by that length over its base radius.
    rotation = polar + tip_pressure_angle - pair.working_pressure_angle
    roll_length = tip.tip_roll_length - tip.base_radius * rotation
    mate_rotation = (pair.common_tangent - roll_length) / flank.base_radius
    # Polar angle of the edge in the frame of the mate, from the center line of the mate's tooth.
    edge = pair.working_pressure_angle - mate_rotation + flank.base_thickness_half_angle - np.arctan2(y, x)
    radius = np.hypot(x, y)
    # From the root to the form point the radius of the fillet rises, as `np.interp` needs it.
    tool_angle = np.linspace(0.5 * math.pi, flank.form_point.tool_angle, _SAMPLES)
    fillet_radius = flank.trochoid.radius(tool_angle)
    fillet = np.interp(radius, fillet_radius, flank.trochoid.polar_angle(tool_angle))
    below_form = radius < flank.form_radius
    return float(np.max(radius * (fillet - edge), initial=0.0, where=below_form))


def largest_clear_tip(pair: ParallelAxes, gear: Toothing, mate: Toothing) -> float | None:
    """Return the largest tip diameter of `gear` in m that is clear of the fillet of `mate`.

    Returns None if even a tip just above the form diameter interferes.
    """
    # On the line of action the tip may reach the mate's form point: this roll length of `gear`.
    reach = max(pair.common_tangent - mate.form_roll_length, 0.0)
    low = gear.form_radius + _ABOVE_FORM * gear.normal_module
    high = min(gear.tip_radius, math.hypot(gear.base_radius, reach))

    def cuts(radius: float) -> bool:
        tip_diameter = 2.0 * radius
        shorter = replace(gear, tip_diameter=tip_diameter, modification=UNMODIFIED)
        return fillet_penetration(pair, shorter, mate) > FILLET_SLACK * gear.normal_module

    if high <= low or cuts(low):
        return None
    if not cuts(high):
        return 2.0 * high
    for _ in range(_HALVINGS):  # `low` is clear and `high` interferes
        middle = 0.5 * (low + high)
        if cuts(middle):
            high = middle
        else:
            low = middle
    return 2.0 * low
