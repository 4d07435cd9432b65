"""A modification of a flank: the removed material, and the flank that is modified."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from fe_contact.geometry import Toothing
from fe_contact.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_unit import Part
from lineofaction.gearbox.from_rexs.loaded_flank import LoadedFlank
from lineofaction.gearbox.units import MM

Removed = Callable[[FloatArray, FloatArray], FloatArray]
"""Material removed in m at roll lengths and at coordinates from the datum face, both in m."""

_SAME = 1e-6  # distance over the flank within which places are equal: a writer's rounding


@dataclass(frozen=True)
class Modification:
    """A modification of a flank: the removed material, and equivalent fields of the case."""

    part: Part
    removed: Removed
    fields: Mapping[str, Any] = field(default_factory=dict)
    """Fields of the case that state the modification; empty if no field does."""
    rolls: tuple[float, ...] = ()
    faces: tuple[float, ...] = ()
    """`rolls`, `faces`: Kinks of the modification: roll lengths, and coordinates from the datum face, m."""


@dataclass(frozen=True)
class PlainFlank:
    """The flank of a gear without modifications, and places on it: roll lengths and face coordinates, m."""

    gear: Toothing
    loaded: LoadedFlank

    @property
    def tip(self) -> float:
        """Roll length of the tip circle."""
        return self.gear.tip_roll_length

    @property
    def root(self) -> float:
        """Roll length where the involute begins."""
        return self.gear.form_roll_length

    @property
    def towards_tip(self) -> float:
        """1 if roll lengths grow towards the tip, -1 of a ring gear."""
        return math.copysign(1.0, self.tip - self.root)

    @property
    def width(self) -> float:
        """Face width."""
        return self.gear.face_width

    def roll_length(self, part: Part, diameter: str, meaning: str) -> float | None:
        """Return the roll length of a diameter outside the base circle, None where the file gives none."""
        value = part.number(diameter, meaning)
        if not value:
            return None
        radius, base = 0.5 * abs(value), self.gear.base_radius
        if radius <= base:
            raise part.refusal(diameter, value / MM, f"above the base diameter {2.0 * base / MM:.7g} mm")
        return math.sqrt(radius**2 - base**2)

    def reference_roll(self, part: Part, diameter: str, length: str, end: float) -> float:
        """Return the roll length where an amount is stated, by diameter or roll length; else `end`."""
        meaning = "where the amount is stated"
        roll = self.roll_length(part, diameter, meaning)
        return (part.number(length, f"{meaning}: a roll length") if roll is None else roll) or end

    def roll_range(self, part: Part, start: str, ends: Sequence[str]) -> tuple[float, float]:
        """Return the roll lengths over which an amount is stated, by default of the whole flank."""
        first = self.roll_length(part, start, "range of the amount")
        rolls = (self.roll_length(part, end, "range of the amount") for end in ends)
        last = next((roll for roll in rolls if roll is not None), None)
        return (self.root if first is None else first), (self.tip if last is None else last)

    def face_field(self, name: str, *, datum: bool) -> str:
        """Return a field of one face: the case's datum face is the end of negative z in any file."""
        at_negative_z = datum == (self.loaded.datum < 0.0)
        return f"{name}_{'datum_face' if at_negative_z else 'non_datum_face'}"

    def same(self, first: float, second: float) -> bool:
        """Return whether two roll lengths or face coordinates are one."""
        return abs(first - second) <= _SAME * max(abs(self.tip - self.root), self.width)

    def radial(self, roll_length: float, end: float) -> float:
        """Return the radial distance in mm between two roll lengths."""
        first, second = (math.hypot(self.gear.base_radius, length) for length in (roll_length, end))
        return abs(second - first) / MM
