"""The effects of the multibody model, one line each, and what is left out."""

from __future__ import annotations

from dynamics.system.effects.axial import Axial
from dynamics.system.effects.backlash import Backlash
from dynamics.system.effects.bearing_clearance import BearingClearance
from dynamics.system.effects.dynamic_center_distance import DynamicCenterDistance
from dynamics.system.effects.dynamic_misalignment import DynamicMisalignment
from dynamics.system.effects.effect import Effect, MeshEffect
from dynamics.system.effects.flexible_shafts import FlexibleShafts
from dynamics.system.effects.friction import Friction
from dynamics.system.effects.gyroscopic import Gyroscopic
from dynamics.system.effects.lateral import Lateral
from dynamics.system.effects.moving_application_point import MovingApplicationPoint
from dynamics.system.effects.tilt import Tilt

EFFECTS: tuple[Effect, ...] = (
    Lateral(),
    Axial(),
    Tilt(),
    BearingClearance(),
    Gyroscopic(),
    FlexibleShafts(),
)

MESH_EFFECTS: tuple[MeshEffect, ...] = (
    Backlash(),
    DynamicMisalignment(),
    DynamicCenterDistance(),
    MovingApplicationPoint(),
    Friction(),
)

LEFT_OUT: dict[str, str] = {
    "centrifugal loads": "of planets on their pins; the terms of displacements are in the effect gyroscopic",
    "gravity": "weights are small against mesh forces",
    "friction of bearings": "bearings turn without loss",
    "point of application along the path of contact": "the mesh force acts at the operating pitch point",
    "flexible members of planetary sets": "sun, ring, carrier and planets are rigid on their shafts",
    "damping that turns with a flexible shaft": "material damping acts as if the shaft stood",
}
