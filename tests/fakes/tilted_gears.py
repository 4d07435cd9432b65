"""Gaps between rigid involute helicoids whose axes are tilted against each other, by rotation in space."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fe_contact.contact.model import Break
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray

SAMPLES, REACH = 81, 0.6e-3
"""Points of the wheel's profile on both sides of the one that touches, and how far, m of its roll length."""
UP = np.array([0.0, 0.0, 1.0])


def _involute(radius: FloatArray, base: float) -> FloatArray:
    """Polar angle of an involute from its root on the base circle, rad."""
    unwound = np.sqrt(np.maximum((radius / base) ** 2 - 1.0, 0.0))
    return np.asarray(unwound - np.arctan(unwound))


def rigid_gap(pair: ParallelAxes, roll: FloatArray, face: FloatArray, tilt: float) -> FloatArray:
    """Return the way of the pinion's flanks to sections of the wheel's, m on the line of action.

    x points from the pinion's axis to the pitch point; seen from +z the pinion turns clockwise. The wheel is
    rotated by `tilt` (rad) about the axis through the pitch point in mid-face that is normal to the plane of
    action, such that it leaves the pinion at positive z. It ends at its tip circle, the pinion does not.

    Parameters
    ----------
    roll, face : ndarray
        Roll lengths of gear 1 at which parallel flanks touch on the line of action, and face positions, m.
    """
    angle, twist, sign = pair.working_pressure_angle, np.tan(pair.base_helix_angle), pair.wheel.sign
    bases = pair.pinion.base_radius, pair.wheel.base_radius
    line = np.array([np.sin(angle), -np.cos(angle), 0.0])  # in which the pinion pushes
    foot = bases[0] * np.array([np.cos(angle), np.sin(angle), 0.0])
    center = np.array([sign * pair.center_distance, 0.0, 0.0])
    roll, face = (each[..., None] for each in np.broadcast_arrays(roll, face))
    touching = foot + (roll + face * twist) * line  # of the same pair of teeth at mid-face
    rolls = pair.mating_roll_length(roll) + np.linspace(-REACH, REACH, SAMPLES)
    tip = pair.wheel.tip_roll_length
    radius = np.hypot(np.clip(rolls, *((0.0, tip) if sign > 0 else (tip, np.inf))), bases[1])
    polar = _root(touching - center, bases[1]) + _involute(radius, bases[1]) - sign * twist / bases[1] * face
    x, y, z = radius * np.cos(polar), radius * np.sin(polar), face + 0.0 * radius
    points = np.stack([x, y, z], axis=-1) + center
    moved = _rotated(points - line_pitch(pair), np.cross(UP, line), tilt) + line_pitch(pair)
    flank = _root(touching, bases[0]) + _involute(np.hypot(moved[..., 0], moved[..., 1]), bases[0])
    ahead = flank + twist / bases[0] * moved[..., 2] - np.arctan2(moved[..., 1], moved[..., 0])
    return np.asarray(bases[0] * np.min((ahead + np.pi) % (2.0 * np.pi) - np.pi, axis=-1))


def line_pitch(pair: ParallelAxes) -> FloatArray:
    """Return the pitch point in mid-face."""
    return np.array([pair.operating_pitch_radii[0], 0.0, 0.0])


def _root(point: FloatArray, base: float) -> FloatArray:
    """Return the polar angle at which the involutes through points begin (..., 1)."""
    angle = np.arctan2(point[..., 1], point[..., 0])
    return np.asarray(angle - _involute(np.hypot(point[..., 0], point[..., 1]), base))[..., None]


def _rotated(points: FloatArray, axis: FloatArray, angle: float) -> FloatArray:
    along = (points @ axis)[..., None] * axis
    return np.asarray(along + np.cos(angle) * (points - along) + np.sin(angle) * np.cross(axis, points))


@dataclass(frozen=True)
class TiltedGap:
    """What a tilt (rad) of the wheel opens between flanks that would touch at their roll lengths."""

    tilt: float
    along_profile: ClassVar[bool] = False

    def breaks(self, pair: ParallelAxes, face: FloatArray) -> tuple[Break, ...]:
        """None."""
        return ()

    def __call__(
        self, pair: ParallelAxes, roll_1: FloatArray, roll_2: FloatArray, face: FloatArray
    ) -> FloatArray:
        """Return it in m."""
        return rigid_gap(pair, roll_1, face, self.tilt) - rigid_gap(pair, roll_1, face, 0.0)
