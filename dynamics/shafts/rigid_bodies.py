"""Rigid bodies on a shaft: gears by teeth, base radius and helix, and discs that mesh with nothing."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from bounds import Declared, Kind, SiNote, between, declared, described
from dynamics.checks import declared_fields, finite, integer, positive, within
from dynamics.shafts.bodies import EXPANSION, STEEL_EXPANSION, TEMPERATURE, Inertia

_MID_FACE = Declared(
    Kind.LENGTH, "m", between(-1000.0, 1000.0), "Mid-face along the shaft, from its left end", 0.1
)


_CENTER = Declared(
    Kind.LENGTH, "m", between(-1000.0, 1000.0), "Center of mass along the shaft, from its left end", 0.1
)


@described
@dataclass(frozen=True)
class GearBody:
    """An involute gear, rigid, concentric with its `shaft`, its `name` unique among the gears.

    Meshing gears have the same transverse base pitch ``2 pi base_radius / teeth``; `base_radius` and
    `face_width` in m. `base_helix_angle` in rad is > 0 for right hand, < 0 for left hand, 0 for spur.
    `inertia` is that of the gear alone, about its own center at mid-face. The teeth of a ring gear
    (`internal`) point inwards; all numbers stay positive. `base_tooth_thickness` is the transverse thickness
    of a tooth at the base circle, an arc in m, to which the flanks of a ring gear are extended; None: not
    known, assumed half the pitch on the operating pitch circle where a phase depends on it.
    """

    name: str
    shaft: str
    position: float = field(metadata={Declared: _MID_FACE})
    teeth: int
    base_radius: float
    face_width: float
    base_helix_angle: float = 0.0
    inertia: Inertia = field(default_factory=Inertia)
    internal: bool = False
    base_tooth_thickness: float | None = None
    temperature: float | None = declared(None, TEMPERATURE)
    thermal_expansion: float = declared(STEEL_EXPANSION, EXPANSION)

    def __post_init__(self) -> None:
        declared_fields(self)
        integer("teeth", self.teeth, 1, 100_000)
        positive("base_radius", self.base_radius)
        positive("face_width", self.face_width)
        if self.base_tooth_thickness is not None:
            finite("base_tooth_thickness", self.base_tooth_thickness)
        within("base_helix_angle", self.base_helix_angle, -1.2, 1.2, SiNote("Angles are in radians."))

    @property
    def base_pitch(self) -> float:
        """Transverse base pitch, m."""
        return 2.0 * math.pi * self.base_radius / self.teeth


@described
@dataclass(frozen=True)
class DiscBody:
    """A rigid body of revolution fixed on a `shaft`, its `name` unique among the discs.

    `inertia` is about its own center of mass, which lies on the axis at `position`, m from the shaft's left
    end.
    """

    name: str
    shaft: str
    position: float = field(metadata={Declared: _CENTER})
    inertia: Inertia = field(default_factory=Inertia)

    def __post_init__(self) -> None:
        declared_fields(self)
