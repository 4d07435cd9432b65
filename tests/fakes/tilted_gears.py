"""Gaps between rigid involute helicoids whose axes are tilted against each other, by rotation in space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fe_contact.contact.model import Break
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray

SAMPLES, REACH = 81, 0.6e-3
"""Points of the wheel's profile on both sides of the one that touches, and how far, m of its roll length."""


def _involute(radius: FloatArray, base: float) -> FloatArray:
    """Polar angle of an involute from its root on the base circle, rad."""
    unwound = np.sqrt(np.maximum((radius / base) ** 2 - 1.0, 0.0))
    return np.asarray(unwound - np.arctan(unwound))


@dataclass(frozen=True)
class RigidFlanks:
    """Both flanks of a pair of teeth that touches at the roll length `roll` (m) of gear 1 at mid-face.

    x points from the pinion's axis to the pitch point; seen from +z the pinion turns clockwise.
    """

    pair: ParallelAxes
    roll: float

    def opened(self, face: float, tilt: float) -> float:
        """Return the way of the pinion's flank to the wheel's section `face`, m on the line of action.

        The wheel is rotated by `tilt` (rad) about the axis through the pitch point in mid-face that is normal
        to the plane of action, such that it leaves the pinion at positive z. The wheel ends at its tip.
        """
        pair = self.pair
        base_1, base_2, twist = pair.pinion.base_radius, pair.wheel.base_radius, np.tan(pair.base_helix_angle)
        line, foot = self._line_of_action()
        second = self._wheel_center()
        start_1 = self._root(foot + self.roll * line, np.zeros(2), base_1)
        start_2 = self._root(foot + self.roll * line, second, base_2)
        by_height = twist / base_2 * (-1.0 if pair.wheel.sign > 0 else 1.0)
        at = float(pair.mating_roll_length(self.roll - face * twist))
        rolls = np.linspace(at - REACH, at + REACH, SAMPLES)
        ends = pair.wheel.tip_roll_length
        rolls = np.clip(rolls, *((0.0, ends) if pair.wheel.sign > 0 else (ends, np.inf)))
        radius = np.hypot(rolls, base_2)
        angle = start_2 + _involute(radius, base_2) + by_height * face
        points = np.stack(
            [
                second[0] + radius * np.cos(angle),
                second[1] + radius * np.sin(angle),
                np.full(radius.shape, face),
            ]
        )
        moved = self._rotated(points, line, tilt)
        radius = np.hypot(moved[0], moved[1])
        flank = start_1 + _involute(radius, base_1) + twist / base_1 * moved[2]
        ahead = flank - np.arctan2(moved[1], moved[0])
        return float(base_1 * np.min((ahead + np.pi) % (2.0 * np.pi) - np.pi))

    def _line_of_action(self) -> tuple[FloatArray, FloatArray]:
        """Return its direction, in which the pinion pushes, and the foot of the pinion's axis on it."""
        angle = self.pair.working_pressure_angle
        line = np.array([np.sin(angle), -np.cos(angle)])
        return line, self.pair.pinion.base_radius * np.array([np.cos(angle), np.sin(angle)])

    def _wheel_center(self) -> FloatArray:
        return np.array([self.pair.wheel.sign * self.pair.center_distance, 0.0])

    def _root(self, point: FloatArray, center: FloatArray, base: float) -> float:
        """Return the polar angle about `center` at which the involute through `point` begins."""
        x, y = point - center
        return float(np.arctan2(y, x) - _involute(np.hypot(x, y), base))

    def _rotated(self, points: FloatArray, line: FloatArray, tilt: float) -> FloatArray:
        pitch_point = np.array([self.pair.operating_pitch_radii[0], 0.0, 0.0])[:, None]
        along, up = np.array([*line, 0.0]), np.array([0.0, 0.0, 1.0])
        axis = np.cross(up, along)
        own = points - pitch_point
        across = np.outer(axis, axis @ own)
        turned = np.cos(tilt) * (own - across) + np.sin(tilt) * np.cross(axis, own, axis=0) + across
        return np.asarray(turned + pitch_point)


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
        rolls, faces = np.broadcast_arrays(roll_1, face)
        twist = np.tan(pair.base_helix_angle)
        gap = np.empty(rolls.shape)
        for at in np.ndindex(rolls.shape):
            flanks, z = RigidFlanks(pair, float(rolls[at] + faces[at] * twist)), float(faces[at])
            gap[at] = flanks.opened(z, self.tilt) - flanks.opened(z, 0.0)
        return gap
