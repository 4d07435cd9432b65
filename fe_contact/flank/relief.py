"""Relief: from zero where it starts to its amount at the end of its length, along a line or a parabola."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds import SiNote
from fe_contact.checks import within
from fe_contact.flank.fields import Shape
from fe_contact.flank.part import ReliefStart
from fe_contact.flank.tooth import Tooth
from fe_contact.types import FloatArray


def course(shape: Shape, fraction: FloatArray) -> FloatArray:
    """Relative depth of a relief at `fraction` of its length: 0 before it starts, 1 from its end on."""
    inside = np.clip(fraction, 0.0, 1.0)
    return inside if shape == "linear" else inside**2


def check_length(field: str, length: float, room: float) -> None:
    """Raise `InputError` if a relief is longer than the room in m that there is for it."""
    within(f"modification.{field}", length, 0.0, room, SiNote("Lengths are in m: 1 mm is 0.001."))


@dataclass(frozen=True)
class ProfileRelief:
    """A relief over the roll length.

    Attributes
    ----------
    amount : float
        m.
    shape : {"linear", "parabolic"}
    start, end : float
        Roll lengths in m; the amount is reached at `end`, which is beyond `start` towards tip or root.
    """

    amount: float
    shape: Shape
    start: float
    end: float

    def removed(self, roll: FloatArray) -> FloatArray:
        """Material removed in m at roll lengths in m."""
        return np.asarray(self.amount * course(self.shape, (roll - self.start) / (self.end - self.start)))

    def begins(self, gear: Tooth) -> ReliefStart:
        """Return where it begins, with slope and curvature over the arc length of the flank.

        The fraction u of its length grows with the arc d as du/dd = r_b/(l |end - start|), and l l' = +-r_b.
        """
        amount, start, end = self.amount, self.start, self.end
        towards_tip = end == gear.tip_roll_length
        slope = gear.base_radius / (start * abs(end - start))
        if self.shape == "parabolic":
            return ReliefStart(start, towards_tip, 0.0, 2.0 * amount * slope**2)
        bend = -amount * gear.base_radius**2 / (start**3 * (end - start))
        return ReliefStart(start, towards_tip, amount * slope, bend)
