"""The exact transverse flank of a tooth: involute, fillet, root and tip arcs.

Tooth frame: gear center at the origin, tooth center line on +y, the right flank (x > 0). One coordinate s
runs over the whole flank from the tooth space's center up to the tip: on the involute it is the arc length
from the base circle, s = l^2 / (2 r_b); below the form point it goes on by the arc length along fillet and
root circle, so that s may be negative there. With the standard's negative radii of an internal gear the
same definition gives s = -l^2 / (2 r_b): again rising from the root to the tip, and negative throughout.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from bounds import from_to
from fe_contact.errors import InputError
from fe_contact.geometry.toothing import Toothing
from fe_contact.involute import involute_normal, involute_point
from fe_contact.types import BoolArray, FloatArray


class FlankProfile:
    """Right flank of one tooth of `gear`; mirror x for the left one.

    The gear's modification is not part of the profile: it enters the analysis as a gap.
    """

    if TYPE_CHECKING:

        @property
        def gear(self) -> Toothing:
            """The gear; a field of the classes that inherit."""

    @property
    def pitch_angle(self) -> float:
        """Angle from one tooth to the next, rad."""
        return 2.0 * math.pi / self.gear.teeth

    @property
    def s_tip(self) -> float:
        """Flank coordinate of the tip edge, m."""
        return self._arc(self.gear.tip_roll_length)

    @property
    def s_form(self) -> float:
        """Flank coordinate of the form point, m."""
        return self._arc(self.gear.form_roll_length)

    @property
    def s_root(self) -> float:
        """Flank coordinate where the fillet ends on the root circle, m."""
        return self.s_form - self.fillet_length

    @property
    def s_space(self) -> float:
        """Flank coordinate of the tooth space's center, on the root circle, m; the lowest."""
        return self.s_root - self.gear.root_radius * (0.5 * self.pitch_angle - self.root_angle)

    @cached_property
    def fillet_length(self) -> float:
        """Arc length of the fillet, m."""
        start = self.gear.form_point.tool_angle
        return float(self.gear.trochoid.arc_length(start, np.array(0.5 * math.pi)))

    @property
    def root_angle(self) -> float:
        """Angle from the tooth's center line to the fillet's end on the root circle, rad."""
        return self.gear.trochoid.root_angle

    @property
    def tip_angle(self) -> float:
        """Angle from the tooth's center line to the tip edge, rad."""
        return 0.5 * self.gear.tip_tooth_thickness / self.gear.tip_radius

    def roll_length(self, s: ArrayLike) -> FloatArray:
        """Roll length in m at flank coordinates on the involute (s >= 0; s <= 0 of an internal gear)."""
        arc = self.gear.sign * np.asarray(s, dtype=float)
        return np.asarray(np.sqrt(2.0 * self.gear.base_radius * arc), dtype=float)

    def involute(self, roll_length: ArrayLike) -> FloatArray:
        """Points (n, 2) in m of the involute at `roll_length` (n,)."""
        gear, roll = self.gear, np.asarray(roll_length, dtype=float)
        return involute_point(gear.base_radius, gear.base_thickness_half_angle, gear.sign * roll)

    def fillet(self, arc: ArrayLike) -> FloatArray:
        """Points (n, 2) in m of the fillet at arc lengths (n,) measured downwards from the form point."""
        return self.gear.trochoid.point(self._tool_angle(np.asarray(arc, dtype=float)))

    def root_land(self, arc: ArrayLike) -> FloatArray:
        """Points (n, 2) in m of the root circle at arc lengths (n,) from the fillet's end outwards."""
        angle = self.root_angle + np.asarray(arc, dtype=float) / self.gear.root_radius
        return self.gear.root_radius * np.stack((np.sin(angle), np.cos(angle)), axis=-1)

    def tip_land(self, fraction: ArrayLike) -> FloatArray:
        """Points (n, 2) in m of the tip arc; `fraction` 0 is the right flank's tip edge, 1 the left one's."""
        angle = self.tip_angle * (1.0 - 2.0 * np.asarray(fraction, dtype=float))
        return self.gear.tip_radius * np.stack((np.sin(angle), np.cos(angle)), axis=-1)

    def flank(self, s: ArrayLike) -> FloatArray:
        """Points in m, shape (..., 2), at flank coordinates `s` from `s_space` to `s_tip`.

        Raises `InputError`: a coordinate outside the profile.
        """
        coordinate = self._checked(s)
        points = np.empty((*coordinate.shape, 2))
        involute, fillet, land = self._parts(coordinate)
        points[involute] = self.involute(self.roll_length(coordinate[involute]))
        points[fillet] = self.fillet(self.s_form - coordinate[fillet])
        points[land] = self.root_land(self.s_root - coordinate[land])
        return points

    def normal(self, s: ArrayLike) -> FloatArray:
        """Outward unit normals, shape (..., 2), at flank coordinates `s`.

        At the form point it is the involute's, which differs from the fillet's with undercut.
        """
        coordinate = self._checked(s)
        normals = np.empty((*coordinate.shape, 2))
        involute, fillet, land = self._parts(coordinate)
        gear = self.gear
        roll = gear.sign * self.roll_length(coordinate[involute])
        normals[involute] = involute_normal(gear.base_radius, gear.base_thickness_half_angle, roll)
        normals[fillet] = gear.trochoid.normal(self._tool_angle(self.s_form - coordinate[fillet]))
        normals[land] = gear.sign * self.root_land(self.s_root - coordinate[land]) / gear.root_radius
        return normals

    def _arc(self, roll_length: float) -> float:
        """Arc length of the involute from the base circle, m; negative for an internal gear."""
        return self.gear.sign * 0.5 * roll_length**2 / self.gear.base_radius

    def _tool_angle(self, arc: FloatArray) -> FloatArray:
        return self.gear.trochoid.angle_at_arc(self.gear.form_point.tool_angle, arc)

    def _checked(self, s: ArrayLike) -> FloatArray:
        """Return `s` as an array, its rounding errors at both ends removed."""
        coordinate = np.asarray(s, dtype=float)
        slack = 1e-9 * self.gear.normal_module  # rounding of coordinates
        if not np.all((coordinate >= self.s_space - slack) & (coordinate <= self.s_tip + slack)):
            bound = from_to(self.s_space, self.s_tip, "m")
            raise InputError("s", s, bound, "Flank coordinates run from s_space to s_tip.")
        return np.asarray(np.clip(coordinate, self.s_space, self.s_tip), dtype=float)

    def _parts(self, s: FloatArray) -> tuple[BoolArray, BoolArray, BoolArray]:
        """Masks of the coordinates on the involute, the fillet and the root circle."""
        involute, land = s >= self.s_form, s < self.s_root
        return involute, ~(involute | land), land


@dataclass(frozen=True)
class ToothProfile(FlankProfile):
    """Right flank of one tooth; a ring gear's points towards the center. Make it by `tooth_profile`."""

    gear: Toothing


@lru_cache(maxsize=256)
def tooth_profile(gear: Toothing) -> ToothProfile:
    """Return the tooth profile of a `Gear` or a `RingGear`."""
    return ToothProfile(gear)
