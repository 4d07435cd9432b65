"""A shaft: one body that carries gears and rests on bearings, rigid unless its sections say how it bends."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from itertools import accumulate
from typing import Protocol

from bounds import Declared, Kind, Quantity, Text, between, declared, described, required, up_to
from dynamics.checks import declared_fields, finite
from dynamics.errors import InputError
from dynamics.shafts.beam_section import BeamSection
from dynamics.shafts.bodies import EXPANSION, STEEL_EXPANSION, TEMPERATURE, Inertia

SAME_POSITION = 1e-9
"""Distance of two positions over the shaft's length, below which they coincide. n added lengths round by n
eps of their sum.
"""

PLACED = ("gears", "discs", "bushings", "rolling_bearings", "planet_bearings", "forces", "unbalances")
"""Kinds of parts of a scene that lie within the length of their shaft."""

_LENGTH = Declared(Kind.LENGTH, "m", up_to(1000.0), "Length, from the left end towards +z", 0.2)
_DAMPING = Declared(
    Kind.RATIO,
    "",
    between(0.0, 1.0),
    "Damping ratio of the material, in every elastic natural motion of the free shaft",
    0.005,
)


class OnShaft(Protocol):
    """A part at a position on a shaft, m from its left end."""

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def shaft(self) -> str: ...  # noqa: D102
    @property
    def position(self) -> float: ...  # noqa: D102


def on_length(position: float, length: float) -> bool:
    """Whether `position` (m from the left end) is on a shaft of `length`, m, but for rounding."""
    return -SAME_POSITION * length <= position <= (1.0 + SAME_POSITION) * length


def nearest_on(position: float, length: float) -> float:
    """Return the position on a shaft of `length` nearest to `position`, m from the left end."""
    return min(max(position, 0.0), length)


@described
@dataclass(frozen=True)
class Shaft:
    """A shaft, its axis parallel to the fixed z axis.

    Its `name` is unique among the shafts. `origin` is the axis point at the left end, m, in the fixed frame
    (x, y, z). `frame` is the carrier's shaft in whose rotating frame origin and displacements are described:
    that of all members of a planetary set (sun, ring, planets and the carrier itself, which names itself);
    `origin` is then the position at t = 0. None: the fixed frame. `inertia` is that of the bare shaft, its
    center of mass at mid-length; the gears on it are added. It is left out if `sections` are given: from the
    left end, together as long as the shaft, for the effect ``"flexible_shafts"`` and for the inertia.
    `tooth_angles` are those of the center of a tooth of each of its gears about +z, rad, at mid-face, in the
    order of the gears; only their differences count. None: tooth centers in line, unless the rest of the
    train fixes the angle.
    """

    name: str
    length: float = required(_LENGTH)
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia: Inertia = field(default_factory=Inertia)
    frame: str | None = None
    tooth_angles: tuple[float, ...] | None = None
    sections: tuple[BeamSection, ...] = ()
    damping_ratio: float = declared(0.005, _DAMPING)
    temperature: float | None = declared(None, TEMPERATURE)
    thermal_expansion: float = declared(STEEL_EXPANSION, EXPANSION)

    def __post_init__(self) -> None:
        declared_fields(self)
        if self.sections:
            self._check_sections()
        for axis, value in zip("xyz", self.origin, strict=True):
            finite(f"origin.{axis}", value)
        for index, value in enumerate(self.tooth_angles or ()):
            finite(f"tooth_angles[{index}]", value)

    def _check_sections(self) -> None:
        """Sections make up the shaft, and its inertia."""
        together = math.fsum(section.length for section in self.sections)
        if abs(together / self.length - 1.0) > SAME_POSITION:
            bound = Text.of("sections that are together as long as the shaft, ", Quantity(self.length, "m"))
            raise InputError("sections", Quantity(together, "m"), bound)
        if self.inertia != Inertia():
            raise InputError("inertia", self.inertia.mass, "left out where sections are given")

    @cached_property
    def bodies(self) -> tuple[tuple[Inertia, float], ...]:
        """Parts of the bare shaft: inertia about its own center, and its position from the left end, m."""
        if not self.sections:
            return ((self.inertia, self.length / 2.0),)
        ends = [0.0, *accumulate(section.length for section in self.sections)]
        parts = (section.body for section in self.sections)
        return tuple((inertia, start + z) for (inertia, z), start in zip(parts, ends, strict=False))
