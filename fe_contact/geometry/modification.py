"""Flank modifications (ISO 21771-1, clause 7; ISO 1328-1 for the slopes).

All amounts are material removed, in m, normal to the involute in the transverse plane (along the line of
action).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from fe_contact.checks import finite, positive, within
from fe_contact.errors import InputError
from fe_contact.types import FloatArray

if TYPE_CHECKING:
    from fe_contact.geometry.gear import Gear

Shape = Literal["linear", "parabolic"]
SHAPES: tuple[Shape, ...] = ("linear", "parabolic")
_ACROSS_FACE = (
    "helix_crowning",
    "helix_slope",
    "end_relief",
    "end_relief_length",
    "end_relief_shape",
    "flank_twist",
)
_LARGEST = 0.01  # m; catches micrometres given as metres


@dataclass(frozen=True)
class FlankModification:
    """Intended departures of one gear's flanks from the involute helicoid.

    Attributes
    ----------
    tip_relief, root_relief : float
        Amount removed at the tip circle and at the form circle, m, >= 0.
    tip_relief_length, root_relief_length : float
        Radial extent from the tip circle inwards and from the form circle outwards, m; must be given with an
        amount.
    tip_relief_shape, root_relief_shape : {"linear", "parabolic"}
        Course over the roll length, from zero where the relief starts.
    profile_crowning : float
        Removed at both ends of the involute, m, >= 0; parabolic over the roll length, zero at its middle.
    profile_slope : float
        Difference in m between tip and form point, linear over the roll length and zero at its middle: > 0
        removes half of it at the tip and adds half at the form point.
    helix_crowning : float
        Removed at both ends of the face, m, >= 0; parabolic, zero at mid-face.
    helix_slope : float
        Difference in m between the two ends of the face, linear and zero at mid-face: > 0 removes half of it
        at the end of positive face position.
    end_relief, end_relief_length : float
        Amount removed at both ends of the face, m, >= 0, and its extent along the face, m.
    end_relief_shape : {"linear", "parabolic"}
        Course over the face.
    flank_twist : float
        Removed in m at the tip end of positive face position and at the opposite corner, added at the other
        two; bilinear over roll length and face, zero at the middle of either. The profile slope so grows by
        four times the amount from one end of the face to the other.
    """

    tip_relief: float = 0.0
    tip_relief_length: float = 0.0
    tip_relief_shape: Shape = "linear"
    root_relief: float = 0.0
    root_relief_length: float = 0.0
    root_relief_shape: Shape = "linear"
    profile_crowning: float = 0.0
    profile_slope: float = 0.0
    helix_crowning: float = 0.0
    helix_slope: float = 0.0
    end_relief: float = 0.0
    end_relief_length: float = 0.0
    end_relief_shape: Shape = "linear"
    flank_twist: float = 0.0

    def __post_init__(self) -> None:
        for kind in ("tip", "root", "end"):
            _check_relief(self, f"{kind}_relief")
        for crowning in ("profile_crowning", "helix_crowning"):
            within(crowning, getattr(self, crowning), 0.0, _LARGEST, "In m: 5 um is 5e-6.")
        for slope in ("profile_slope", "helix_slope", "flank_twist"):
            within(slope, getattr(self, slope), -_LARGEST, _LARGEST, "In m: 5 um is 5e-6.")

    @property
    def neutral(self) -> bool:
        """Whether nothing is removed anywhere."""
        return not (self.varies_along_profile or self.varies_along_face)

    @property
    def varies_along_profile(self) -> bool:
        """Whether the modification depends on the roll length, at any place of the face."""
        alone = (self.tip_relief, self.root_relief, self.profile_crowning, self.profile_slope)
        return any((*alone, self.flank_twist))

    @property
    def varies_along_face(self) -> bool:
        """Whether the modification depends on the face position, at any roll length."""
        return any((self.helix_crowning, self.helix_slope, self.end_relief, self.flank_twist))

    @property
    def along_profile(self) -> FlankModification:
        """The part that is the same all over the face."""
        return replace(self, **{name: getattr(UNMODIFIED, name) for name in _ACROSS_FACE})

    @property
    def along_face(self) -> FlankModification:
        """The part that differs over the face; where it twists the flank, it varies along the profile too."""
        return FlankModification(**{name: getattr(self, name) for name in _ACROSS_FACE})

    def check_fits(self, gear: Gear) -> None:
        """Raise `InputError` if a relief is longer than the involute is high or half the face is wide."""
        height = gear.tip_radius - gear.form_radius
        advice = "Lengths are in m: 1 mm is 0.001."
        within("modification.tip_relief_length", self.tip_relief_length, 0.0, height, advice)
        within("modification.root_relief_length", self.root_relief_length, 0.0, height, advice)
        within("modification.end_relief_length", self.end_relief_length, 0.0, 0.5 * gear.face_width, advice)

    def material_removed(
        self, gear: Gear, roll_length: ArrayLike, face_position: ArrayLike = 0.0
    ) -> FloatArray:
        """Material removed normal to the involute, in the transverse plane.

        Parameters
        ----------
        gear : Gear
            The gear the modification belongs to.
        roll_length : array_like
            Roll lengths in m; outside the involute its end value is taken.
        face_position : array_like, optional
            Distance from mid-face in m, broadcast against `roll_length`.

        Returns
        -------
        array
            m, >= 0 except where a slope or twist adds material; exactly zero for a neutral modification.
        """
        roll, face = np.broadcast_arrays(np.asarray(roll_length, float), np.asarray(face_position, float))
        removed = np.zeros(roll.shape)
        roll = np.clip(roll, gear.form_roll_length, gear.tip_roll_length)
        if self.varies_along_profile:
            removed += self._along_profile(gear, roll)
        if self.varies_along_face:
            removed += self._along_face(gear, face)
        if self.flank_twist:
            removed += self.flank_twist * _across_profile(gear, roll) * _across_face(gear, face)
        return removed

    def _along_profile(self, gear: Gear, roll: FloatArray) -> FloatArray:
        """Reliefs, crowning and slope over the roll length."""
        form, tip = gear.form_roll_length, gear.tip_roll_length
        across = _across_profile(gear, roll)
        removed = self.profile_crowning * across**2 + 0.5 * self.profile_slope * across
        if self.tip_relief:
            start = gear.roll_length(gear.tip_radius - self.tip_relief_length)
            removed += self.tip_relief * _course(self.tip_relief_shape, (roll - start) / (tip - start))
        if self.root_relief:
            start = gear.roll_length(gear.form_radius + self.root_relief_length)
            removed += self.root_relief * _course(self.root_relief_shape, (start - roll) / (start - form))
        return np.asarray(removed, dtype=float)

    def _along_face(self, gear: Gear, face: FloatArray) -> FloatArray:
        """End relief, crowning and slope over the face."""
        across = _across_face(gear, face)
        removed = self.helix_crowning * across**2 + 0.5 * self.helix_slope * across
        if self.end_relief:
            from_start = (np.abs(face) - 0.5 * gear.face_width) / self.end_relief_length + 1.0
            removed = removed + self.end_relief * _course(self.end_relief_shape, from_start)
        return np.asarray(removed, dtype=float)


def _across_profile(gear: Gear, roll: FloatArray) -> FloatArray:
    """Place on the involute: -1 at the form point, +1 at the tip, linear over the roll length."""
    form, tip = gear.form_roll_length, gear.tip_roll_length
    return np.asarray((2.0 * roll - form - tip) / (tip - form))


def _across_face(gear: Gear, face: FloatArray) -> FloatArray:
    """Place on the face: -1 and +1 at its ends."""
    return np.asarray(2.0 * face / gear.face_width)


def _course(shape: Shape, fraction: FloatArray) -> FloatArray:
    """Relative depth of a relief at `fraction` of its length: 0 before it starts, 1 from its end on."""
    inside = np.clip(fraction, 0.0, 1.0)
    return inside if shape == "linear" else inside**2


def _check_relief(modification: FlankModification, kind: str) -> None:
    """Check amount, length and shape of one relief."""
    amount, length = getattr(modification, kind), getattr(modification, f"{kind}_length")
    shape = getattr(modification, f"{kind}_shape")
    within(kind, amount, 0.0, _LARGEST, "In m: 20 um is 20e-6.")
    if shape not in SHAPES:
        raise InputError(f"{kind}_shape", shape, 'one of "linear" and "parabolic"')
    finite(f"{kind}_length", length)
    if amount:
        positive(f"{kind}_length", length, f"{kind} needs the length over which it acts, in m.")
    elif length < 0.0:
        raise InputError(f"{kind}_length", length, "at least 0")


UNMODIFIED = FlankModification()
