"""End relief: material removed towards both ends of the face."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds import Direction
from fe_contact.flank.fields import Shape, amount, length, shape
from fe_contact.flank.part import FlankPart
from fe_contact.flank.relief import check_length, course
from fe_contact.flank.tooth import Tooth
from fe_contact.types import FloatArray

_FACE = Direction.FACE


@dataclass(frozen=True, kw_only=True)
class EndRelief(FlankPart):
    """Relief over the same length at either end of the face."""

    end_relief: float = amount(_FACE, "End relief at both faces", 10e-6)
    end_relief_length: float = length(_FACE, "Length of the end relief along the face", 2e-3)
    end_relief_shape: Shape = shape(_FACE, "End relief over its length")

    def check_fits(self, gear: Tooth) -> None:
        """Raise `InputError` if it is longer than half the face."""
        check_length("end_relief_length", self.end_relief_length, 0.5 * gear.face_width)

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        from_start = (np.abs(face_position) - 0.5 * gear.face_width) / self.end_relief_length + 1.0
        return np.asarray(self.end_relief * course(self.end_relief_shape, from_start))
