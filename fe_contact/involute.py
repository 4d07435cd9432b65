"""The involute of a circle (ISO 21771-1, clause 4.3).

A point of an involute is named by its roll length l: the distance, along the normal, from the point to
where the normal touches the base circle. It is also the radius of curvature there.
"""

from __future__ import annotations

import math

import numpy as np

from fe_contact.types import FloatArray


def involute_function(pressure_angle: float) -> float:
    """inv(alpha) = tan(alpha) - alpha, in rad."""
    return math.tan(pressure_angle) - pressure_angle


def inverse_involute(value: float) -> float:
    """Return the angle alpha in [0, pi/2) whose involute function is `value` >= 0.

    Newton's iteration on a convex function, started above the root, so that it descends monotonically.
    """
    if value < 0.0:
        raise ValueError(f"the involute function of a positive angle is not {value!r}")
    if value == 0.0:
        return 0.0
    angle = min(math.cbrt(3.0 * value), math.atan(value + math.pi / 2.0))
    for _ in range(100):
        step = (math.tan(angle) - angle - value) / math.tan(angle) ** 2
        angle -= step
        if abs(step) <= 1e-15 * angle:
            break
    return angle


def roll_length_at_radius(base_radius: float, radius: float) -> float:
    """Roll length in m of the point at `radius` >= `base_radius`."""
    return math.sqrt((radius - base_radius) * (radius + base_radius))


def radius_at_roll_length(base_radius: float, roll_length: float) -> float:
    """Radius in m of the point at a roll length in m."""
    return math.hypot(base_radius, roll_length)


def involute_point(base_radius: float, half_angle: float, roll_length: FloatArray) -> FloatArray:
    """Points of a right flank in the tooth frame.

    Parameters
    ----------
    base_radius : float
        Base radius in m.
    half_angle : float
        Half the tooth's angle at the base circle, rad.
    roll_length : (n,) array
        Roll lengths in m.

    Returns
    -------
    (n, 2) array
        Coordinates in m; gear center at the origin, tooth center line on +y.
    """
    radial = half_angle - roll_length / base_radius
    sine, cosine = np.sin(radial), np.cos(radial)
    x = base_radius * sine + roll_length * cosine
    y = base_radius * cosine - roll_length * sine
    return np.stack((x, y), axis=-1)


def involute_normal(base_radius: float, half_angle: float, roll_length: FloatArray) -> FloatArray:
    """Outward unit normals (n, 2) of the right flank at `roll_length` (n,); see `involute_point`."""
    radial = half_angle - roll_length / base_radius
    return np.stack((np.cos(radial), -np.sin(radial)), axis=-1)
