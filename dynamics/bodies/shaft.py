"""A shaft: one body that carries gears and rests on bearings, rigid unless its sections say how it bends."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import accumulate

from bounds import Quantity, Text
from dynamics.bodies.inertia import Inertia, hollow_cylinder
from dynamics.bodies.shaft_position import SAME_POSITION
from dynamics.bodies.timoshenko_beam import BeamSection
from dynamics.checks import finite, not_negative, positive
from dynamics.errors import InputError

DEFAULT_DAMPING_RATIO = 0.005


@dataclass(frozen=True)
class Shaft:
    """A shaft, its axis parallel to the fixed z axis.

    Attributes
    ----------
    name : str
        Unique among the shafts.
    length : float
        m, from the left end towards +z.
    origin : tuple of three floats
        The axis point at the left end, m, in the fixed frame (x, y, z).
    frame : str or None
        The carrier's shaft in whose rotating frame this shaft's origin and displacements are described: that
        of all members of a planetary set (sun, ring, planets and the carrier itself, which names itself).
        `origin` is then the position at t = 0. None: the fixed frame.
    inertia : Inertia
        Of the bare shaft, its center of mass at mid-length; the gears on it are added. Left out where
        `sections` are given.
    sections : tuple of BeamSection
        From the left end, together as long as the shaft: for the effect ``"flexible_shafts"``, and for the
        inertia. Empty: the shaft is rigid.
    damping_ratio : float
        Of the material: of every elastic natural motion of the free shaft.
    """

    name: str
    length: float
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia: Inertia = field(default_factory=Inertia)
    frame: str | None = None
    sections: tuple[BeamSection, ...] = ()
    damping_ratio: float = DEFAULT_DAMPING_RATIO

    def __post_init__(self) -> None:
        positive("length", self.length)
        not_negative("damping_ratio", self.damping_ratio)
        if self.sections:
            self._check_sections()
        for axis, value in zip("xyz", self.origin, strict=True):
            finite(f"origin.{axis}", value)

    def _check_sections(self) -> None:
        """Sections make up the shaft, and its inertia."""
        together = math.fsum(section.length for section in self.sections)
        if abs(together / self.length - 1.0) > SAME_POSITION:
            bound = Text.of("sections that are together as long as the shaft, ", Quantity(self.length, "m"))
            raise InputError("sections", Quantity(together, "m"), bound)
        if self.inertia != Inertia():
            raise InputError("inertia", self.inertia.mass, "left out where sections are given")

    @property
    def cylinders(self) -> tuple[tuple[Inertia, float], ...]:
        """Parts of the bare shaft: inertia about its own center, and its position from the left end, m."""
        if not self.sections:
            return ((self.inertia, self.length / 2.0),)
        ends = [0.0, *accumulate(section.length for section in self.sections)]
        return tuple(
            (hollow_cylinder(s.outer_diameter, s.length, s.bore_diameter, s.density), start + s.length / 2.0)
            for s, start in zip(self.sections, ends, strict=False)
        )
