"""The flank of a gear that carries the load, and the face from which its width counts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from lineofaction.gearbox.from_rexs.gear_unit import Part
from lineofaction.gearbox.from_rexs.meshing import Meshing
from lineofaction.gearbox.from_rexs.placement import frame_of

_DIRECTIONS = {"positive": 1.0, "negative": -1.0}


@dataclass(frozen=True)
class LoadedFlank:
    """The flank that carries, and where its face coordinates lie in the case."""

    gear: Part
    side: str
    """``"right"`` or ``"left"``, seen from the datum face."""
    flank: Part | None
    other: Part | None
    """`flank`, `other`: The flank that carries and its counterpart; None where the file has none."""
    datum: float
    """1 if the datum face is at the end of positive z, -1 if at the other."""

    @classmethod
    def of(cls, meshing: Meshing, gear: Part) -> LoadedFlank:
        """Return the flank of a gear that carries in a stage."""
        u_along_z = 1.0 if float(np.dot(frame_of(gear).u, meshing.z)) > 0.0 else -1.0
        datum = u_along_z * _datum_along_u(gear)
        sides = ("right", "left") if datum > 0.0 else ("left", "right")
        flank, other = (next(iter(gear.related("flank", "gear", side)), None) for side in sides)
        return cls(gear, sides[0], flank, other, datum)

    @property
    def flanks(self) -> Iterator[Part]:
        """The flanks that the file has, the loaded one first."""
        return (flank for flank in (self.flank, self.other) if flank is not None)


def _datum_along_u(gear: Part) -> float:
    """Return 1 if the datum face is in the direction of the gear's u axis, -1 if in the other."""
    word = gear.text("datum_face_orientation", "from where flanks and coordinates are seen")
    if word in _DIRECTIONS:
        return _DIRECTIONS[word]
    default = "negative: coordinates of the face count along +u"
    gear.say("datum_face_orientation", "defaulted" if word is None else "refused", default)
    return -1.0
