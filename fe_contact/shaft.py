"""The shaft that carries a gear between two bearings."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, SiNote, between, declared, described, required, up_to
from fe_contact.errors import declared_fields, within
from fe_contact.material import STEEL, Material

_LENGTH = Declared(Kind.LENGTH, "m", up_to(50.0), "Distance between the bearings", 0.2)

_DIAMETER = Declared(Kind.LENGTH, "m", between(1e-6, 10.0), "Diameter", 0.04)

_POSITION = Declared(
    Kind.LENGTH,
    "m",
    between(-50.0, 100.0),
    "Mid-face of the gear towards +z from the bearing of smaller z; overhangs by at most the length",
    0.06,
)

_STIFFNESS = Declared(
    Kind.STIFFNESS,
    "N/m",
    up_to(1e15),
    "Radial stiffness of each bearing; left out: rigid",
    4e8,
    written="N/µm",
)


@described
@dataclass(frozen=True)
class Shaft:
    """A round shaft of constant diameter on two radial bearings, with the gear between or beside them.

    A gear whose position is negative or beyond the length overhangs; +z is along the pinion's axis. Raises
    `InputError`: a value out of its bounds.
    """

    length: float = required(_LENGTH)
    diameter: float = required(_DIAMETER)
    position: float = required(_POSITION)
    bearing_stiffness: float | None = declared(None, _STIFFNESS)
    material: Material = STEEL

    def __post_init__(self) -> None:
        declared_fields(self)
        remedy = SiNote("In m from the bearing of smaller z; a gear may overhang by one length.")
        within("position", self.position, -self.length, 2.0 * self.length, remedy)


Shafts = tuple[Shaft | None, Shaft | None]
"""Shafts of the driving and the driven gear; None is rigid."""
