"""Sliding of a pair in closed form: its teeth say where they touch, and share the load equally."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dynamics.types import FloatArray

SMOOTHING = 0.01
"""Half width of the smoothed change of direction at the pitch point, base pitches; as in computed tables."""
POSITIONS = 64
"""Least number of positions in a base pitch."""
POINTS = 33
"""Number of points over the face of helical teeth at which contact is searched."""
ADDENDUM = 1.0
"""Modules on the operating pitch circle: tips of standard teeth (ISO 53)."""


@dataclass(frozen=True)
class StandardTeeth:
    """The teeth of a pair as far as sliding depends on them; SI."""

    teeth: tuple[int, int]
    """Numbers of teeth of pinion and wheel."""
    base_radius: float
    """Base radius of the pinion, m."""
    working_pressure_angle: float
    base_helix_angle: float
    face_width: float
    internal: bool = False
    """Whether the wheel is a ring gear."""

    @property
    def base_pitch(self) -> float:
        """Transverse base pitch, m."""
        return 2.0 * math.pi * self.base_radius / self.teeth[0]

    @property
    def path(self) -> tuple[float, float]:
        """Ends A and E of the path of contact from the pitch point, m."""
        sign = -1.0 if self.internal else 1.0
        beyond = self._beyond(self.teeth[0], 1.0)
        before = sign * self._beyond(self.teeth[1], sign)
        return -before, beyond

    def _beyond(self, teeth: int, sign: float) -> float:
        """Return the distance from the pitch point to a tip circle along the line of action, m."""
        base = self.base_radius * teeth / self.teeth[0]
        pitch_radius = base / math.cos(self.working_pressure_angle)
        tip = pitch_radius * (1.0 + sign * 2.0 * ADDENDUM / teeth)
        return math.sqrt(max(tip**2 - base**2, 0.0)) - base * math.tan(self.working_pressure_angle)


def sliding_positions(position: FloatArray) -> FloatArray:
    """Return positions (P,) of a table, and the further ones that its sliding needs."""
    return np.union1d(position, np.arange(POSITIONS) / POSITIONS)


def standard_sliding(teeth: StandardTeeth, position: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return `sliding_share` (P,) and `sliding_lever` (P,), m, of `MeshTable` at positions (P,).

    The pairs in contact share the load in proportion to the length of their lines of contact.
    """
    first, last = teeth.path
    pitch, half = teeth.base_pitch, 0.5 * teeth.face_width * math.tan(abs(teeth.base_helix_angle))
    reach = math.ceil((max(-first, last) + half) / pitch) + 1
    center = (position[:, None] + np.arange(-reach, reach + 1)) * pitch
    across = half * np.linspace(-1.0, 1.0, POINTS) if half > 0.0 else np.zeros(1)
    y = center[:, :, None] + across
    touching = ((y >= first) & (y <= last)).astype(float)
    weight = touching / np.maximum(np.sum(touching, axis=(1, 2), keepdims=True), 1.0)
    root = np.sqrt(y**2 + (SMOOTHING * pitch) ** 2)
    return np.sum(weight * y / root, axis=(1, 2)), np.sum(weight * y**2 / root, axis=(1, 2))
