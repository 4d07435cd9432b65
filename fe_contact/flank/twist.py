"""Flank twist: bilinear over profile and face, zero in the middle of either."""

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
class FlankTwist(FlankPart):
    """Twist; the profile slope grows by four times the amount from one end of the face to the other."""

    flank_twist: float = slope(
        Direction.PROFILE | Direction.FACE,
        "Twist at the corners of the flank; > 0 removes at the tip where z is positive and at the opposite "
        "corner, adds at the other two",
        5e-6,
    )

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        across = self.flank_twist * across_profile(gear, roll_length)
        return np.asarray(across * across_face(gear, face_position))
