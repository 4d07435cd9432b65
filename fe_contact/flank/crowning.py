"""Crowning: a parabola over the profile or the face, zero in the middle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bounds import Direction
from fe_contact.flank.fields import amount
from fe_contact.flank.part import FlankPart, across_face, across_profile
from fe_contact.types import FloatArray

if TYPE_CHECKING:
    from fe_contact.flank.tooth import Tooth


@dataclass(frozen=True, kw_only=True)
class ProfileCrowning(FlankPart):
    """Crowning over the roll length."""

    profile_crowning: float = amount(Direction.PROFILE, "Profile crowning at both ends of the profile", 5e-6)

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        return np.asarray(self.profile_crowning * across_profile(gear, roll_length) ** 2)


@dataclass(frozen=True, kw_only=True)
class HelixCrowning(FlankPart):
    """Crowning over the face."""

    helix_crowning: float = amount(Direction.FACE, "Lead crowning at both ends of the face", 5e-6)

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        return np.asarray(self.helix_crowning * across_face(gear, face_position) ** 2)
