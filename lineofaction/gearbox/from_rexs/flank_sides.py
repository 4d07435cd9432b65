"""Which flank of a gear carries, and which of its faces is the datum face.

ISO 21771-1: seen from the datum face with the tooth's tip upwards, the right flank is on the right. The case
sees both gears from +z, where right flanks carry; from the other side the same flanks are left. This holds
for a ring gear too, whose tooth is turned so that its tip points upwards.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.meshing import Meshing
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.placement import frame_of

_DIRECTIONS = {"positive": 1.0, "negative": -1.0}


@dataclass(frozen=True)
class LoadedFlank:
    """The flank that carries, and where its face coordinates lie in the case.

    Attributes
    ----------
    gear : Part
    side : str
        ``"right"`` or ``"left"``, seen from the datum face.
    flank, other : Part or None
        The flank that carries and its counterpart; None where the file has none.
    datum : float
        1 if the datum face is at the end of positive z, -1 if at the other.
    """

    gear: Part
    side: str
    flank: Part | None
    other: Part | None
    datum: float

    @property
    def flanks(self) -> Iterator[Part]:
        """The flanks that the file has, the loaded one first."""
        return (flank for flank in (self.flank, self.other) if flank is not None)


def loaded_flank(unit: GearUnit, meshing: Meshing, gear: Part) -> LoadedFlank:
    """Return the flank of a gear that carries in a stage.

    Raises
    ------
    BadInput
        Axes of the gear that are no directions.
    """
    u_along_z = 1.0 if float(np.dot(frame_of(unit, gear).u, meshing.z)) > 0.0 else -1.0
    datum = u_along_z * _datum_along_u(gear)
    sides = ("right", "left") if datum > 0.0 else ("left", "right")
    flank, other = (_flank(unit, gear, side) for side in sides)
    return LoadedFlank(gear, sides[0], flank, other, datum)


def _datum_along_u(gear: Part) -> float:
    """Return 1 if the datum face is in the direction of the gear's u axis, -1 if in the other."""
    word = gear.text("datum_face_orientation", "from where flanks and coordinates are seen")
    if word in _DIRECTIONS:
        return _DIRECTIONS[word]
    default = "negative: coordinates of the face count along +u"
    gear.say("datum_face_orientation", "defaulted" if word is None else "refused", default)
    return -1.0


def _flank(unit: GearUnit, gear: Part, side: str) -> Part | None:
    for relation in unit.relations("flank"):
        number = relation.of_role(side)
        if relation.of_role("gear") == gear.id and number is not None:
            return unit.part(number)
    return None
