"""The fillet curve of a tooth root: points, tangents and arc length."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import lru_cache

import numpy as np

from fe_contact.types import FloatArray

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(48)


class FilletCurve(ABC):
    """Fillet of the right flank, in the tooth frame.

    `tool_angle` names the points: it grows from the fillet's first point, where the involute ends, to pi/2 on
    the root circle.
    """

    @property
    @abstractmethod
    def root_angle(self) -> float:
        """Angle from the tooth's center line to the fillet's end on the root circle, rad."""

    @abstractmethod
    def point(self, tool_angle: FloatArray) -> FloatArray:
        """Points (n, 2) in m."""

    @abstractmethod
    def normal(self, tool_angle: FloatArray) -> FloatArray:
        """Outward unit normals (n, 2)."""

    @abstractmethod
    def radius(self, tool_angle: FloatArray) -> FloatArray:
        """Distance from the gear's center, m; monotone."""

    @abstractmethod
    def polar_angle(self, tool_angle: FloatArray) -> FloatArray:
        """Angle from the tooth's center line, rad; positive on the right flank's side."""

    @abstractmethod
    def speed(self, tool_angle: FloatArray) -> FloatArray:
        """Arc length per tool angle, m/rad."""

    def arc_length(self, start: float, tool_angle: FloatArray) -> FloatArray:
        """Arc length in m from the tool angle `start` to each of `tool_angle` (Gauss-Legendre, 48 points)."""
        half = 0.5 * (np.asarray(tool_angle, dtype=float) - start)
        samples = start + half[..., None] * (1.0 + _NODES)
        return np.asarray(half * (self.speed(samples) @ _WEIGHTS), dtype=float)

    def angle_at_arc(self, start: float, arc: FloatArray) -> FloatArray:
        """Tool angles at which the arc length from `start` equals `arc` (Newton from a table)."""
        return _angles(self, start, arc.tobytes()).reshape(arc.shape)


@lru_cache(maxsize=64)
def _angles(curve: FilletCurve, start: float, arcs: bytes) -> FloatArray:
    """Return the tool angles at arc lengths; every tooth of a mesh is sampled at the same ones."""
    arc = np.frombuffer(arcs)
    angle = np.interp(arc, *_arc_table(curve, start))
    for _ in range(4 if arc.size else 0):
        slope = np.maximum(curve.speed(angle), np.finfo(float).tiny)
        angle = np.clip(angle - (curve.arc_length(start, angle) - arc) / slope, start, 0.5 * np.pi)
    angle.flags.writeable = False
    return np.asarray(angle, dtype=float)


@lru_cache(maxsize=16)
def _arc_table(curve: FilletCurve, start: float) -> tuple[FloatArray, FloatArray]:
    """Return arc lengths from `start` and their tool angles: flanks are evaluated again and again."""
    angle = np.linspace(start, 0.5 * np.pi, 257)
    return curve.arc_length(start, angle), angle
