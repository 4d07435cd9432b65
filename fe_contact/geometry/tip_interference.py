"""Interference of a tip edge with the mating tooth of an internal pair, off the line of action.

A tip edge passes through the mating tooth space while it is inside the mate's tip circle. `polar` is the
angle (n,) of the edge about its own gear, rad, 0 on the line of centers. The rotation of the gears is 0 where
the flanks meet at the pitch point. In the code x lies across the line of centers, y along it, both from the
mate's center.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fe_contact.involute import involute_function
from fe_contact.types import BoolArray, FloatArray

if TYPE_CHECKING:
    from fe_contact.geometry.parallel_axes import ParallelAxes
    from fe_contact.geometry.toothing import Toothing


_EDGE_SAMPLES = 1025
"""Points of the path of a tip edge, and of the fillet that it may cut."""


class _EdgePath(NamedTuple):
    """The path of a tip edge in the mating gear."""

    radius: FloatArray
    """Distance from the mate's center, m. Shape (n,)."""
    depth: FloatArray
    """Arc by which the edge is inside the mate's tooth, m; negative outside. Shape (n,)."""


def tip_interference(pair: ParallelAxes) -> float:
    """Depth in m to which a tip edge cuts the mating involute on its way in or out; 0 if the tips pass."""
    return max(_deepest(path, mate, on_fillet=False) for path, mate in _paths(pair))


def trochoidal_interference(pair: ParallelAxes) -> float:
    """Depth in m to which a tip edge cuts the mating fillet; 0 if clear."""
    return max(_deepest(path, mate, on_fillet=True) for path, mate in _paths(pair))


def pinion_edge_path(pair: ParallelAxes) -> _EdgePath:
    """Path of the pinion's tip edge in the ring's tooth space, from where it enters to where it leaves."""
    pinion, ring = pair.pinion, pair.wheel
    polar = _lens(pair.center_distance, pinion.tip_radius, ring.tip_radius)
    x, y = pinion.tip_radius * np.sin(polar), pair.center_distance + pinion.tip_radius * np.cos(polar)
    radius = np.hypot(x, y)
    # rotation of the pinion from the pitch point, then the angle of the ring's facing flank
    turn = polar + _tip_involute(pinion) - involute_function(pair.working_pressure_angle)
    facing = _pitch_point_angle(pair) + turn / pair.speed_ratio - flank_angle(ring, radius)
    return _EdgePath(radius, radius * (np.arctan2(x, y) - facing))


def ring_edge_path(pair: ParallelAxes) -> _EdgePath:
    """Path of the ring's tip edge in the pinion's tooth space, from where it enters to where it leaves."""
    pinion, ring, working = pair.pinion, pair.wheel, involute_function(pair.working_pressure_angle)
    polar = _lens(-pair.center_distance, ring.tip_radius, pinion.tip_radius)
    x, y = ring.tip_radius * np.sin(polar), ring.tip_radius * np.cos(polar) - pair.center_distance
    radius = np.hypot(x, y)
    # rotation of the pinion from the pitch point, then the angle of its facing flank
    turn = (polar + _tip_involute(ring) - working) * pair.speed_ratio
    facing = turn + working - pinion.base_thickness_half_angle + flank_angle(pinion, radius)
    return _EdgePath(radius, radius * (facing - np.arctan2(x, y)))


def flank_angle(gear: Toothing, radius: FloatArray) -> FloatArray:
    """Angle in rad from the tooth's center line to its right flank at `radius`, on involute and fillet."""
    pressure = np.arccos(np.minimum(1.0, gear.base_radius / radius))
    involute = gear.base_thickness_half_angle - gear.sign * (np.tan(pressure) - pressure)
    # the fillet by samples from the form point to the root; np.interp needs increasing heights
    tool_angle = np.linspace(gear.form_point.tool_angle, 0.5 * math.pi, _EDGE_SAMPLES)
    height = -gear.sign * gear.trochoid.radius(tool_angle)
    fillet = np.interp(-gear.sign * radius, height, gear.trochoid.polar_angle(tool_angle))
    return np.where(_on_fillet(gear, radius), fillet, involute)


def _on_fillet(gear: Toothing, radius: FloatArray) -> BoolArray:
    """Whether a radius lies below the form circle (beyond it in a ring)."""
    return np.asarray(gear.sign * (radius - gear.form_radius) < 0.0)


def _lens(offset: float, tip_radius: float, mating_tip_radius: float) -> FloatArray:
    """Return the angles of a tip edge about its gear while it is inside the mating tip circle, rad.

    `offset` is the center of the gear on the line of centers, counted from the mate's center, m.
    """
    # law of cosines; clipped where the circles do not cross
    cosine = (mating_tip_radius**2 - tip_radius**2 - offset**2) / (2.0 * offset * tip_radius)
    widest = math.acos(max(-1.0, min(1.0, cosine)))
    return np.linspace(-widest, widest, _EDGE_SAMPLES)


def _tip_involute(gear: Toothing) -> float:
    """Return the involute function at the tip circle, rad; 0 for a tip inside the base circle."""
    return involute_function(math.acos(min(1.0, gear.base_radius / gear.tip_radius)))


def _pitch_point_angle(pair: ParallelAxes) -> float:
    """Angle of the ring tooth's center line when its flank is at the pitch point, rad."""
    return pair.wheel.base_thickness_half_angle + involute_function(pair.working_pressure_angle)


def _paths(pair: ParallelAxes) -> tuple[tuple[_EdgePath, Toothing], ...]:
    return (pinion_edge_path(pair), pair.wheel), (ring_edge_path(pair), pair.pinion)


def _deepest(path: _EdgePath, mate: Toothing, on_fillet: bool) -> float:
    """Return the largest depth on the mate's fillet or on its involute, m, at least 0."""
    where = _on_fillet(mate, path.radius) == on_fillet
    return float(np.max(path.depth, initial=0.0, where=where))
