"""The flanks that touch in a mesh: their angles on the base circles when they touch at the pitch point.

Angles of flanks are in pitches of their gear about +z, at the gear's mid-face.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from dynamics.mechanism.line_of_action import LineOfAction
from dynamics.scene.scene import Scene
from dynamics.shafts import GearBody

HALF = 0.5
"""Thickness over pitch on the operating pitch circle, for teeth of unstated thickness."""


@dataclass(frozen=True)
class FlankAtMesh:
    """The flank of a gear that carries in a mesh."""

    gear: int
    sense: int
    """Sense in which the gear turns about +z, +1 or -1."""
    side: int
    """Side to which the flank faces about +z, +1 or -1."""
    at_pitch_point: float
    """Angle of the flank when it touches at the pitch point, pitches."""

    @property
    def key(self) -> tuple[int, int]:
        """Gear and side."""
        return self.gear, self.side

    def position(self, angle: float) -> float:
        """Return the position of the mesh, base pitches, where the flank is at an angle."""
        return self.sense * (angle - self.at_pitch_point)

    def angle(self, position: float) -> float:
        """Return the angle of the flank where the mesh is at a position."""
        return self.at_pitch_point + self.sense * position


def flanks_at_mesh(
    scene: Scene, index: int, line: LineOfAction, sense: int
) -> tuple[FlankAtMesh, FlankAtMesh]:
    """Return the flanks of driver and driven gear that touch in mesh `index`.

    The driver pushes with the flank that looks ahead, the driven gear is pushed on the one that looks back.
    """
    mesh = scene.meshes[index]
    driver, driven = scene.gear(mesh.driver), scene.gear(mesh.driven)
    follows = sense if driver.internal or driven.internal else -sense
    return _flank(scene, driver, line, sense, sense), _flank(scene, driven, line, follows, -follows)


def _flank(scene: Scene, gear: GearBody, line: LineOfAction, sense: int, side: int) -> FlankAtMesh:
    """Return the flank of a gear on one side that touches at the pitch point.

    Its angle on the base circle at mid-face is that of the pitch point, plus the involute from there to the
    base circle, less the turn of the helix from mid-face to the height of the pitch point.
    """
    x, y, z = scene.shaft(gear.shaft).origin
    angle = math.atan2(line.point[1] - y, line.point[0] - x)
    angle += side * _widening(gear, line.working_pressure_angle)
    helix = (line.point[2] - z - gear.position) * math.tan(gear.base_helix_angle) / gear.base_pitch
    at_pitch_point = gear.teeth * angle / (2.0 * math.pi) - helix
    return FlankAtMesh(scene.gears.index(gear), sense, side, float(at_pitch_point))


def _widening(gear: GearBody, pressure_angle: float) -> float:
    """Return the half growth of a tooth's angular thickness from a pressure angle to the base circle, rad.

    The teeth of a ring gear point inwards: they are narrower there.
    """
    involute = math.tan(pressure_angle) - pressure_angle
    return -involute if gear.internal else involute


def base_thickness(scene: Scene, flank: FlankAtMesh, index: int, line: LineOfAction) -> float:
    """Return the tooth thickness of a gear at the base circle in its pitches, assumed where it is not stated.

    `flank` is that of the gear in mesh `index`. Assumed teeth fill half the pitch on the operating pitch
    circle, or what the coast flank of the mesh says.
    """
    gear, mesh = scene.gears[flank.gear], scene.meshes[index]
    if gear.base_tooth_thickness is not None:
        return gear.base_tooth_thickness / gear.base_pitch
    share = HALF
    if mesh.coast is not None:
        driver = mesh.coast.thickness
        # the pitch is filled by a tooth of the driver, one of the driven gear, and the backlash
        share = driver if mesh.driver == gear.name else 1.0 - driver - mesh.coast.backlash / gear.base_pitch
    return share + gear.teeth * _widening(gear, line.working_pressure_angle) / math.pi
