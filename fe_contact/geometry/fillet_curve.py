"""The root of a tooth: its fillet, the trochoid a rack cuts, and where the involute begins."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fe_contact.flank.involute import involute_function, roll_length_at_radius
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


# The tooth root fillet: envelope of the rack tool's tip rounding (a trochoid's equidistant).
#
# The tool's rounding is a circle in the normal plane. Seen in the transverse plane, where the generation
# takes place, it is an ellipse: distances along the pitch line grow by 1/cos(beta), heights do not. Its
# points are named by `tool_angle` theta: the angle between their normal and the pitch line in the normal
# plane, from the pressure angle (where the rounding leaves the straight flank) to pi/2 (the tool's tip,
# which generates the root circle). Every rack point generates the gear point at which its normal passes
# through the pitch point (law of gearing).


@dataclass(frozen=True)
class Trochoid(FilletCurve):
    """Fillet of the right flank, in the tooth frame."""

    reference_radius: float
    """Radius in m of the circle that rolls on the tool's pitch line."""
    corner_distance: float
    """Transverse distance in m along the pitch line from the tooth's center line to the rounding's center."""
    corner_height: float
    """Height in m of the rounding's center above the pitch line (usually negative)."""
    corner_radius: float
    """Radius rho_fP of the rounding in the normal plane, m."""
    helix_angle: float
    """beta in rad."""

    @property
    def root_angle(self) -> float:
        """Angle from the tooth's center line to the fillet's end on the root circle, rad."""
        return self.corner_distance / self.reference_radius

    def height(self, tool_angle: FloatArray) -> FloatArray:
        """Height of the tool's points above the pitch line, m."""
        return self.corner_height - self.corner_radius * np.sin(tool_angle)

    def _normal_slope(self, tool_angle: FloatArray) -> FloatArray:
        return math.cos(self.helix_angle) * np.cos(tool_angle) / np.sin(tool_angle)

    def _rotation(self, tool_angle: FloatArray) -> FloatArray:
        """Angle by which the gear has rolled when the point is generated, rad."""
        distance = self.corner_distance - self.corner_radius * np.cos(tool_angle) / math.cos(self.helix_angle)
        return (distance - self.height(tool_angle) * self._normal_slope(tool_angle)) / self.reference_radius

    def point(self, tool_angle: FloatArray) -> FloatArray:
        """Points (n, 2) in m."""
        height = self.height(tool_angle)
        x, y = height * self._normal_slope(tool_angle), self.reference_radius + height
        return turned_clockwise(x, y, self._rotation(tool_angle))

    def normal(self, tool_angle: FloatArray) -> FloatArray:
        """Outward unit normals (n, 2)."""
        slope = self._normal_slope(tool_angle)
        length = np.hypot(slope, 1.0)
        return turned_clockwise(slope / length, 1.0 / length, self._rotation(tool_angle))

    def radius(self, tool_angle: FloatArray) -> FloatArray:
        """Distance from the gear's center, m; falls monotonically with the tool angle."""
        height = self.height(tool_angle)
        return np.hypot(height * self._normal_slope(tool_angle), self.reference_radius + height)

    def polar_angle(self, tool_angle: FloatArray) -> FloatArray:
        """Angle from the tooth's center line, rad; positive on the right flank's side."""
        height = self.height(tool_angle)
        offset = np.arctan2(height * self._normal_slope(tool_angle), self.reference_radius + height)
        return self._rotation(tool_angle) + offset

    def speed(self, tool_angle: FloatArray) -> FloatArray:
        """Arc length per tool angle, m/rad.

        The tool's own arc plus the sliding between tool and gear, which is the distance to the pitch point
        times the gear's rotation.
        """
        sine, cosine, ratio = np.sin(tool_angle), np.cos(tool_angle), math.cos(self.helix_angle)
        height, radius = self.height(tool_angle), self.corner_radius
        along = radius * sine / ratio
        rolled = along + radius * cosine * self._normal_slope(tool_angle) + height * ratio / sine**2
        tangential = along + height * rolled / self.reference_radius
        return np.asarray(tangential * np.hypot(self._normal_slope(tool_angle), 1.0), dtype=float)


def turned_clockwise(x: FloatArray, y: FloatArray, angle: FloatArray) -> FloatArray:
    """Turn vectors (x, y) clockwise by `angle`."""
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.stack((x * cosine + y * sine, y * cosine - x * sine), axis=-1)


# The form point: where involute and fillet meet, with or without undercut.


@dataclass(frozen=True)
class FormPoint:
    """End of the usable involute at the root."""

    roll_length: float
    """Roll length of the form point in m, >= 0."""
    tool_angle: float
    """Tool angle of the fillet's first point (see `Trochoid`), rad."""
    undercut: bool
    """Whether the fillet cuts the involute; if not, it leaves it with a common tangent."""


def find_form_point(
    trochoid: Trochoid,
    normal_pressure_angle: float,
    tangent_roll_length: float,
    base_radius: float,
    base_half_angle: float,
) -> FormPoint:
    """Find where the fillet meets the involute.

    Parameters
    ----------
    normal_pressure_angle : float
        alpha_n in rad: the tool angle at which the tool's rounding begins.
    tangent_roll_length : float
        Roll length in m generated by the end of the tool's straight flank; negative when the tool reaches
        past the point where the line of action touches the base circle, which is undercut.
    base_radius, base_half_angle : float
        Base radius in m and half the tooth's angle there, rad.

    Notes
    -----
    With undercut, the fillet's upper end lies outside the tooth and its point on the base circle inside, so
    the polar angles of fillet and involute at equal radius cross exactly once between.
    """
    if tangent_roll_length >= 0.0:
        return FormPoint(tangent_roll_length, normal_pressure_angle, undercut=False)

    from scipy.optimize import brentq  # noqa: PLC0415 (start-up time)

    def radius(tool_angle: float) -> float:
        return float(trochoid.radius(np.array(tool_angle)))

    def outside(tool_angle: float) -> float:
        pressure = math.acos(min(1.0, base_radius / radius(tool_angle)))
        involute = base_half_angle - involute_function(pressure)
        return float(trochoid.polar_angle(np.array(tool_angle))) - involute

    low, high = normal_pressure_angle, 0.5 * math.pi
    if radius(low) <= base_radius:  # an undercut below rounding error
        return FormPoint(0.0, low, undercut=False)
    at_base = brentq(lambda angle: radius(angle) - base_radius, low, high, xtol=1e-15, rtol=1e-15)
    if outside(low) <= 0.0 or outside(at_base) >= 0.0:  # likewise
        return FormPoint(0.0, at_base, undercut=True)
    cut = brentq(outside, low, at_base, xtol=1e-15, rtol=1e-15)
    return FormPoint(roll_length_at_radius(base_radius, max(base_radius, radius(cut))), cut, undercut=True)
