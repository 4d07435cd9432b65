"""Tip relief and root relief (ISO 21771-1, 7.2): material removed towards either end of the profile."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from bounds import Direction
from fe_contact.flank.fields import Shape, amount, length, shape
from fe_contact.flank.part import FlankPart, ReliefStart
from fe_contact.flank.relief import ProfileRelief, check_length
from fe_contact.flank.tooth import Tooth
from fe_contact.types import FloatArray

_PROFILE = Direction.PROFILE


@dataclass(frozen=True, kw_only=True)
class RadialRelief(FlankPart):
    """Relief from a radius to one end of the involute; its fields carry the name of the relief."""

    _name: ClassVar[str]

    def check_fits(self, gear: Tooth) -> None:
        """Raise `InputError` if it is longer than the involute."""
        field = f"{self._name}_length"
        check_length(field, getattr(self, field), abs(gear.tip_radius - gear.form_radius))

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        return self._relief(gear).removed(roll_length)

    def relief_starts(self, gear: Tooth) -> tuple[ReliefStart, ...]:
        """Return where it begins."""
        return (self._relief(gear).begins(gear),)

    def _relief(self, gear: Tooth) -> ProfileRelief:
        """Return it over the roll length of its gear."""
        raise NotImplementedError


@dataclass(frozen=True, kw_only=True)
class TipRelief(RadialRelief):
    """Relief from a radius to the tip circle."""

    _name = "tip_relief"

    tip_relief: float = amount(_PROFILE, "Tip relief at the tip diameter", 20e-6)
    tip_relief_length: float = length(_PROFILE, "Length of the tip relief along the radius", 1.5e-3)
    tip_relief_shape: Shape = shape(_PROFILE, "Tip relief over its length")

    def _relief(self, gear: Tooth) -> ProfileRelief:
        """Return it over the roll length of its gear."""
        start = gear.roll_length(gear.tip_radius - gear.sign * self.tip_relief_length)
        return ProfileRelief(self.tip_relief, self.tip_relief_shape, start, gear.tip_roll_length)


@dataclass(frozen=True, kw_only=True)
class RootRelief(RadialRelief):
    """Relief from a radius to the form circle."""

    _name = "root_relief"

    root_relief: float = amount(_PROFILE, "Root relief at the start of the involute", 10e-6)
    root_relief_length: float = length(_PROFILE, "Length of the root relief along the radius", 1e-3)
    root_relief_shape: Shape = shape(_PROFILE, "Root relief over its length")

    def _relief(self, gear: Tooth) -> ProfileRelief:
        """Return it over the roll length of its gear."""
        start = gear.roll_length(gear.form_radius + gear.sign * self.root_relief_length)
        return ProfileRelief(self.root_relief, self.root_relief_shape, start, gear.form_roll_length)
