"""Crowning, slope (ISO 1328-1) and twist: powers of the position on profile and face, zero in the middle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bounds import Direction, declarations
from fe_contact.flank.part import FlankPart, Tooth
from fe_contact.flank.relief import amount, slope
from fe_contact.types import FloatArray


class Polynomial(FlankPart):
    """A depth times u^m v^n, u and v running from -1 to 1 over the roll length and over the face.

    Attributes
    ----------
    powers : tuple of int
        m and n.
    weight : float
        Of the depth: one half where it is the difference between two ends.
    """

    powers: ClassVar[tuple[int, int]]
    weight: ClassVar[float] = 1.0

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        (depth,) = (getattr(self, field) for field in declarations(type(self)))
        form, tip = gear.form_roll_length, gear.tip_roll_length
        u = (2.0 * roll_length - form - tip) / (tip - form)
        v = 2.0 * face_position / gear.face_width
        return np.asarray(self.weight * depth * u ** self.powers[0] * v ** self.powers[1])


@dataclass(frozen=True, kw_only=True)
class ProfileCrowning(Polynomial):
    """Crowning over the roll length."""

    profile_crowning: float = amount(Direction.PROFILE, "Profile crowning at both ends of the profile", 5e-6)
    powers: ClassVar[tuple[int, int]] = (2, 0)


@dataclass(frozen=True, kw_only=True)
class HelixCrowning(Polynomial):
    """Crowning over the face."""

    helix_crowning: float = amount(Direction.FACE, "Lead crowning at both ends of the face", 5e-6)
    powers: ClassVar[tuple[int, int]] = (0, 2)


@dataclass(frozen=True, kw_only=True)
class ProfileSlope(Polynomial):
    """Slope over the roll length."""

    profile_slope: float = slope(
        Direction.PROFILE,
        "Profile slope, linear over the roll length; > 0 removes half at the tip, adds half at the root",
        5e-6,
    )
    powers: ClassVar[tuple[int, int]] = (1, 0)
    weight: ClassVar[float] = 0.5


@dataclass(frozen=True, kw_only=True)
class HelixSlope(Polynomial):
    """Slope over the face."""

    helix_slope: float = slope(
        Direction.FACE,
        "Helix slope over the face width; > 0 removes half at the end of positive z, adds half at the other",
        5e-6,
    )
    powers: ClassVar[tuple[int, int]] = (0, 1)
    weight: ClassVar[float] = 0.5


@dataclass(frozen=True, kw_only=True)
class FlankTwist(Polynomial):
    """Twist; the profile slope grows by four times the amount from one end of the face to the other."""

    flank_twist: float = slope(
        Direction.PROFILE | Direction.FACE,
        "Twist at the corners of the flank; > 0 removes at the tip where z is positive and at the opposite "
        "corner, adds at the other two",
        5e-6,
    )
    powers: ClassVar[tuple[int, int]] = (1, 1)
