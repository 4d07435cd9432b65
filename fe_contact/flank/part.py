"""A modification of a flank, and the numbers of the tooth that it depends on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, reduce
from operator import or_
from typing import ClassVar

import numpy as np

from bounds import Direction, Kind, SiNote, at_least, declarations
from fe_contact.errors import InputError, declared_fields
from fe_contact.flank.tooth import Tooth
from fe_contact.types import FloatArray

_ACTING = (Kind.AMOUNT, Kind.DEVIATION, Kind.EDGE)
"""Kinds of fields that remove material if they are not zero; the others say where or how."""
SHORTEST = 1e-9
"""Shortest length over which an amount acts, m. A shorter one is a step, whose slope is undefined."""


@dataclass(frozen=True)
class ReliefStart:
    """Start of a relief, or of a rounded or chamfered tip edge, along the profile.

    At the distance d from the start the relief removes jump d + bend d^2/2.
    """

    roll_length: FloatArray | float
    """Roll length, m; an array over the face positions where it varies over the face."""
    towards_tip: bool
    """Whether the relief runs to the tip; else to the root."""
    jump: FloatArray | float
    bend: FloatArray | float
    """`jump`, `bend`: Slope and curvature at the start of the relief, over the arc length of the flank; 1 and
    1/m.
    """
    ends_flank: bool = False
    """Whether the start is the edge of a rounded or chamfered tip, where the usable flank ends."""


@dataclass(frozen=True)
class FlankPart:
    """One departure of a gear's flanks from the involute helicoid.

    A modification is a dataclass of declared fields (`fe_contact.flank.relief`) that computes the material
    it removes. It removes nothing while its amounts, deviations and edges are zero. Raises `InputError`: a
    value out of its bound, or an amount ``x`` without the ``x_length`` over which it acts.
    """

    def __post_init__(self) -> None:
        declared_fields(self)
        for field, fact in declarations(type(self)).items():
            amount = field.removesuffix("_length")
            if fact.kind is Kind.LENGTH and getattr(self, amount) and getattr(self, field) < SHORTEST:
                bound = at_least(SHORTEST, "m", note=f" where {amount.replace('_', ' ')} acts over it")
                raise InputError(field, getattr(self, field), bound, SiNote("In m: 1.5 mm is 0.0015."))

    @cached_property
    def along(self) -> Direction:
        """Directions along which the modification can act."""
        return reduce(or_, (fact.along for fact in declarations(type(self)).values()), Direction.NONE)

    @cached_property
    def varies(self) -> Direction:
        """Directions along which the modification acts; none if it removes nothing."""
        items = declarations(type(self)).items()
        acting = (fact.along for field, fact in items if fact.kind in _ACTING and getattr(self, field))
        return reduce(or_, acting, Direction.NONE)

    def check_fits(self, gear: Tooth) -> None:
        """Raise `InputError` if the gear has no room for the modification."""

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """Material removed in m at roll lengths inside the involute and at face positions, both in m."""
        raise NotImplementedError

    def relief_starts(self, gear: Tooth, face_position: FloatArray | float = 0.0) -> tuple[ReliefStart, ...]:
        """Return the starts along the profile at face positions, m, that are within the flank."""
        return ()


def involute(gear: Tooth) -> tuple[float, float]:
    """Return the least and the largest roll length of the involute, m."""
    ends = gear.form_roll_length, gear.tip_roll_length
    return min(ends), max(ends)


class Polynomial(FlankPart):
    """A depth times u^m v^n - c, u and v running from -1 to 1 over the roll length and over the face."""

    powers: ClassVar[tuple[int, int]]
    """Exponents m and n."""
    weight: ClassVar[float] = 1.0
    """Weight of the depth: one half where the depth is the difference between two ends."""
    mean: ClassVar[float] = 0.0
    """Constant c: 1/3 where the mean line of a parabola is zero."""

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        (depth,) = (getattr(self, field) for field in declarations(type(self)))
        form, tip = gear.form_roll_length, gear.tip_roll_length
        u = (2.0 * roll_length - form - tip) / (tip - form)
        v = 2.0 * face_position / gear.face_width
        shape = u ** self.powers[0] * v ** self.powers[1]
        return np.asarray(self.weight * depth * (shape - self.mean if self.mean else shape))
