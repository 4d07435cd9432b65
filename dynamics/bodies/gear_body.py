"""A rigid gear fixed on a shaft, as dynamics sees it: teeth, base radius, helix, inertia."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from bounds import SiNote
from dynamics.bodies.inertia import Inertia
from dynamics.checks import finite, integer, positive, within


@dataclass(frozen=True)
class GearBody:
    """An involute gear, rigid, concentric with its shaft.

    Attributes
    ----------
    name : str
        Unique among the gears.
    shaft : str
        The shaft that carries it.
    position : float
        Of mid-face along the shaft, m from the shaft's left end.
    teeth : int
        Number of teeth.
    base_radius : float
        m. Meshing gears have the same transverse base pitch ``2 pi base_radius / teeth``.
    face_width : float
        m.
    base_helix_angle : float
        rad; > 0: right hand, < 0: left hand, 0: spur.
    inertia : Inertia
        Of the gear alone, about its own center at mid-face.
    internal : bool
        True: a ring gear, its teeth point inwards. All numbers stay positive.
    """

    name: str
    shaft: str
    position: float
    teeth: int
    base_radius: float
    face_width: float
    base_helix_angle: float = 0.0
    inertia: Inertia = field(default_factory=Inertia)
    internal: bool = False

    def __post_init__(self) -> None:
        finite("position", self.position)
        integer("teeth", self.teeth, 1, 100_000)
        positive("base_radius", self.base_radius)
        positive("face_width", self.face_width)
        within("base_helix_angle", self.base_helix_angle, -1.2, 1.2, SiNote("Angles are in radians."))

    @property
    def base_pitch(self) -> float:
        """Transverse base pitch, m."""
        return 2.0 * math.pi * self.base_radius / self.teeth
