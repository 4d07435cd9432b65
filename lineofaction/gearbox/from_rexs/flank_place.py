"""Places on the flank of a gear, from diameters, roll lengths and face coordinates of REXS."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from fe_contact.geometry import Toothing
from fe_contact.types import FloatArray
from lineofaction.gearbox.from_rexs.flank_sides import LoadedFlank
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import MM, UM

Removed = Callable[[FloatArray, FloatArray], FloatArray]
"""Material removed in m at roll lengths and at coordinates from the datum face, both in m."""
_SAME = 1e-6  # of the flank: places that a writer's rounding sets apart are one


@dataclass(frozen=True)
class Modification:
    """A modification of a flank: what it removes, and fields of the case that say the same.

    Attributes
    ----------
    removed : callable
    fields : mapping
        Empty where the case has none for it.
    rolls, faces : tuple of float
        Where it has kinks: roll lengths, coordinates from the datum face, m.
    """

    part: Part
    removed: Removed
    fields: Mapping[str, Any] = field(default_factory=dict)
    rolls: tuple[float, ...] = ()
    faces: tuple[float, ...] = ()


@dataclass(frozen=True)
class FlankPlace:
    """The flank of a gear.

    Attributes
    ----------
    gear : Toothing
        Without modifications.
    loaded : LoadedFlank
    """

    gear: Toothing
    loaded: LoadedFlank

    @property
    def tip(self) -> float:
        """Roll length of the tip circle, m."""
        return self.gear.tip_roll_length

    @property
    def root(self) -> float:
        """Roll length where the involute begins, m."""
        return self.gear.form_roll_length

    @property
    def towards_tip(self) -> float:
        """1 if roll lengths grow towards the tip, -1 of a ring gear."""
        return math.copysign(1.0, self.tip - self.root)

    @property
    def width(self) -> float:
        """Face width, m."""
        return self.gear.face_width

    def roll_length(self, part: Part, diameter: str, words: str) -> float | None:
        """Return the roll length in m of a diameter, None where the file gives none.

        Raises
        ------
        BadInput
            The diameter is inside the base circle.
        """
        value = part.number(diameter, words)
        if not value:
            return None
        radius, base = 0.5 * abs(value), self.gear.base_radius
        if radius <= base:
            bound = f"above the base diameter {2.0 * base / MM:.7g} mm"
            raise BadInput.of(f"{part.place}, {diameter}", value / MM, bound)
        return math.sqrt(radius**2 - base**2)

    def face_field(self, name: str, *, datum: bool) -> str:
        """Return a field of one face: the case's datum face is the end of negative z, whatever the file's."""
        at_negative_z = datum == (self.loaded.datum < 0.0)
        return f"{name}_{'datum_face' if at_negative_z else 'non_datum_face'}"

    def same(self, first: float, second: float) -> bool:
        """Return whether two roll lengths or face coordinates are one."""
        return abs(first - second) <= _SAME * max(abs(self.tip - self.root), self.width)

    def radial(self, roll_length: float, end: float) -> float:
        """Return the radial distance in mm between two roll lengths in m."""
        radii = (math.hypot(self.gear.base_radius, length) for length in (roll_length, end))
        first, second = radii
        return abs(second - first) / MM


def um(value: float) -> float:
    """Return a depth in um without the rounding that a change of units leaves, 12 digits."""
    return float(f"{value / UM:.12g}") + 0.0


def mm(value: float) -> float:
    """Return a length in mm, given in mm, with 12 digits."""
    return float(f"{value:.12g}") + 0.0
