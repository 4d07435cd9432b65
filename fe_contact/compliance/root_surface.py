"""The surface of the tooth root in a mesh, from the middle of the tooth space to the form point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.geometry.flank_profile import FlankProfile
from fe_contact.types import FloatArray, IntArray

SAMPLES = 4001  # of the exact profile that nodes are sought on

STATIONS = np.array([-1.0, 1.0]) / np.sqrt(3.0)
"""Stations of an edge at which its strain is evaluated, in its coordinate from -1 to 1."""

COMPONENTS = 3
"""Components of the surface stress: along the profile, across it, and the shear between them."""


@dataclass(frozen=True)
class RootSurface:
    """Both root fillets of one tooth, each with its half of the root land."""

    nodes: IntArray
    """Nodes of the transverse section from the middle of the tooth space up to the form point: corner,
    mid-side, corner ... First the side of the loaded (right) flank, then the other. Shape (2, 2e + 1).
    """
    s: FloatArray
    """Flank coordinate of both, m, increasing. Shape (2e + 1,)."""


def root_coordinate(profile: FlankProfile, points: FloatArray) -> FloatArray:
    """Return the flank coordinates (n,) in m of points (n, 2) on the root of the right flank.

    The nearest sample of the exact profile, then along its tangent: good to the square of the sample's
    distance over the radius of curvature.
    """
    samples = np.linspace(profile.s_space, profile.s_form, SAMPLES)
    curve = profile.flank(samples)
    nearest = np.argmin(np.linalg.norm(points[:, None] - curve, axis=2), axis=1)
    normal = profile.normal(samples[nearest])
    tangent = profile.gear.sign * np.stack([-normal[:, 1], normal[:, 0]], axis=1)  # towards the tip
    along = np.sum((points - curve[nearest]) * tangent, axis=1)
    return np.asarray(samples[nearest] + along)


def between_nodes(values: FloatArray) -> FloatArray:
    """Return values (..., 2e + 1) at the nodes of quadratic edges at their stations, (..., 2e)."""
    low, middle, high = values[..., :-2:2], values[..., 1::2], values[..., 2::2]
    x = STATIONS[:, None]
    at_stations = 0.5 * x * (x - 1.0) * low[..., None, :] + (1.0 - x * x) * middle[..., None, :]
    at_stations = at_stations + 0.5 * x * (x + 1.0) * high[..., None, :]
    return np.asarray(np.swapaxes(at_stations, -1, -2).reshape(*values.shape[:-1], -1))
