"""The shaft that carries a gear between two bearings."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import SiNote
from fe_contact.checks import positive, within
from fe_contact.material import STEEL, Material


@dataclass(frozen=True)
class Shaft:
    """A round shaft of constant diameter on two radial bearings, with the gear between or beside them.

    Attributes
    ----------
    length : float
        Distance between the bearings, m.
    diameter : float
        m.
    position : float
        Mid-face of the gear as distance in m along the pinion's axis (+z) from the bearing of smaller z;
        negative or above `length` is a gear that overhangs.
    bearing_stiffness : float, optional
        Radial stiffness of each bearing, N/m; None is rigid.
    material : Material

    Raises
    ------
    InputError
        A value out of its bounds.
    """

    length: float
    diameter: float
    position: float
    bearing_stiffness: float | None = None
    material: Material = STEEL

    def __post_init__(self) -> None:
        positive("length", self.length, SiNote("In m: 200 mm is 0.2."))
        positive("diameter", self.diameter, SiNote("In m: 40 mm is 0.04."))
        advice = SiNote("In m from the bearing of smaller z; a gear may overhang by one length.")
        within("position", self.position, -self.length, 2.0 * self.length, advice)
        if self.bearing_stiffness is not None:
            positive("bearing_stiffness", self.bearing_stiffness, SiNote("In N/m; left out: rigid bearings."))


Shafts = tuple[Shaft | None, Shaft | None]
"""Of the driving and the driven gear; None is rigid."""
