"""A rigid gear fixed on a shaft, as dynamics sees it: teeth, base radius, helix, inertia."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from bounds import Declared, Kind, SiNote, between, described
from dynamics.checks import declared_fields, integer, positive, within
from dynamics.shafts.inertia import Inertia

_POSITION = Declared(
    Kind.LENGTH, "m", between(-1000.0, 1000.0), "Mid-face along the shaft, from its left end", 0.1
)


@described
@dataclass(frozen=True)
class GearBody:
    """An involute gear, rigid, concentric with its `shaft`, its `name` unique among the gears.

    Meshing gears have the same transverse base pitch ``2 pi base_radius / teeth``; `base_radius` and
    `face_width` in m. `base_helix_angle` in rad is > 0 for right hand, < 0 for left hand, 0 for spur.
    `inertia` is that of the gear alone, about its own center at mid-face. The teeth of a ring gear
    (`internal`) point inwards; all numbers stay positive.
    """

    name: str
    shaft: str
    position: float = field(metadata={Declared: _POSITION})
    teeth: int
    base_radius: float
    face_width: float
    base_helix_angle: float = 0.0
    inertia: Inertia = field(default_factory=Inertia)
    internal: bool = False

    def __post_init__(self) -> None:
        declared_fields(self)
        integer("teeth", self.teeth, 1, 100_000)
        positive("base_radius", self.base_radius)
        positive("face_width", self.face_width)
        within("base_helix_angle", self.base_helix_angle, -1.2, 1.2, SiNote("Angles are in radians."))

    @property
    def base_pitch(self) -> float:
        """Transverse base pitch, m."""
        return 2.0 * math.pi * self.base_radius / self.teeth
