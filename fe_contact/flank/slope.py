"""Slopes (ISO 1328-1): linear over the profile or the face, zero in the middle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bounds import Direction
from fe_contact.flank.fields import slope
from fe_contact.flank.part import FlankPart, across_face, across_profile
from fe_contact.types import FloatArray

if TYPE_CHECKING:
    from fe_contact.flank.tooth import Tooth


@dataclass(frozen=True, kw_only=True)
class ProfileSlope(FlankPart):
    """Slope over the roll length."""

    profile_slope: float = slope(
        Direction.PROFILE,
        "Profile slope, linear over the roll length; > 0 removes half at the tip, adds half at the root",
        5e-6,
    )

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        return np.asarray(0.5 * self.profile_slope * across_profile(gear, roll_length))


@dataclass(frozen=True, kw_only=True)
class HelixSlope(FlankPart):
    """Slope over the face."""

    helix_slope: float = slope(
        Direction.FACE,
        "Helix slope over the face width; > 0 removes half at the end of positive z, adds half at the other",
        5e-6,
    )

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        return np.asarray(0.5 * self.helix_slope * across_face(gear, face_position))
