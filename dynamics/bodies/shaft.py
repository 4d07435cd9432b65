"""A rigid shaft: one body that carries gears and rests on bearings."""

from __future__ import annotations

from dataclasses import dataclass, field

from dynamics.bodies.inertia import Inertia
from dynamics.checks import finite, positive


@dataclass(frozen=True)
class Shaft:
    """A rigid shaft, its axis parallel to the fixed z axis.

    Attributes
    ----------
    name : str
        Unique among the shafts.
    length : float
        m, from the left end towards +z.
    origin : tuple of three floats
        The axis point at the left end, m, in the fixed frame (x, y, z).
    frame : str or None
        The carrier's shaft in whose turning frame this shaft's place and displacements are described: that
        of all members of a planetary set (sun, ring, planets and the carrier itself, which names itself).
        `origin` is then the place at t = 0. None: the fixed frame.
    inertia : Inertia
        Of the bare shaft, its centre of mass at mid-length; the gears on it are added.
    """

    name: str
    length: float
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia: Inertia = field(default_factory=Inertia)
    frame: str | None = None

    def __post_init__(self) -> None:
        positive("length", self.length)
        for axis, value in zip("xyz", self.origin, strict=True):
            finite(f"origin.{axis}", value)
