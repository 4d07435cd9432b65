"""A gear mesh by itself: the table and the few facts that turn angles into force and torques."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bounds import SiNote, exactly
from dynamics.assembly.assemble import assemble
from dynamics.checks import finite, integer, not_negative, positive, within
from dynamics.errors import InputError
from dynamics.mechanism.base_pitches import EQUAL
from dynamics.mechanism.flanks import DAMPING_REACH
from dynamics.meshes.gear_mesh import CoastFlank
from dynamics.meshes.mesh_table import MeshTable, check_table
from dynamics.scene.scene import Scene

MAX_TEETH = 100_000  # largest number of teeth of a gear


@dataclass(frozen=True)
class MeshElement:
    """The force between the flanks of two gears.

    Angles count in each gear's own sense: the driver's in the sense in which it drives, the driven gear's in
    the sense in which it is driven.
    """

    table: MeshTable
    """Table of mesh forces, with or without axes of misalignment and center-distance change."""
    teeth: tuple[int, int]
    """Numbers of teeth of the driver and the driven gear."""
    base_radius: tuple[float, float]
    """Base radii of the driver and the driven gear, m, both positive."""
    base_helix_angle: float = 0.0
    """Base helix angle of the driver, rad; > 0 is right-handed."""
    damping: float = 0.0
    """Mesh damping in full contact, N s/m."""
    damping_reach: float | None = None
    """Elastic force in N from which the damping acts in full. None: 5 % of the table's last level."""
    position_offset: float = 0.0
    """Position in base pitches where the driver's angle is zero."""
    coast: CoastFlank | None = None
    """The backs of the teeth, alike to their fronts, damped as these; None: they never touch."""

    def __post_init__(self) -> None:
        check_table(self.table, "table")
        for index in range(2):
            integer(f"teeth[{index}]", self.teeth[index], 1, MAX_TEETH)
            positive(f"base_radius[{index}]", self.base_radius[index])
        driven = self.base_radius[1] / self.teeth[1]
        if abs(driven * self.teeth[0] / self.base_radius[0] - 1.0) > EQUAL:
            expected = self.base_radius[0] * self.teeth[1] / self.teeth[0]
            bound = exactly(expected, ", of the driver's base pitch")
            raise InputError("base_radius[1]", self.base_radius[1], bound, "Base pitches must agree to 1e-9.")
        within("base_helix_angle", self.base_helix_angle, -1.2, 1.2, SiNote("Angles are in radians."))
        not_negative("damping", self.damping)
        positive("damping_reach", self.reach)
        finite("position_offset", self.position_offset)
        if self.coast is not None and self.coast.table is not None:
            remedy = "Leave the coast flank out, or run the scene here."
            raise InputError("coast.table", "a table of its own", "None: backs of teeth like fronts", remedy)

    @property
    def reach(self) -> float:
        """Elastic force in N from which the damping acts in full."""
        if self.damping_reach is not None:
            return self.damping_reach
        return DAMPING_REACH * float(self.table.level[-1])

    @property
    def base_pitch(self) -> float:
        """Transverse base pitch, m."""
        return 2.0 * math.pi * self.base_radius[0] / self.teeth[0]


def mesh_element(scene: Scene, mesh: str) -> MeshElement:
    """Return a mesh of a scene with the damping and the table that a run of the scene uses.

    A table with axes keeps them with the variable-torque technique. The constant-torque technique has one
    place on them. The coast flank comes with it where the scene's effect `backlash` is on. Raises
    `InputError`: the scene has no such mesh, or its parts do not fit each other.
    """
    names = [part.name for part in scene.meshes]
    if mesh not in names:
        raise InputError("mesh", mesh, f"one of {', '.join(names)}")
    index = names.index(mesh)
    system = assemble(scene)
    flanks, scene_mesh = system.flanks, scene.meshes[index]
    driver, driven = system.scene.gear(scene_mesh.driver), system.scene.gear(scene_mesh.driven)
    return MeshElement(
        scene_mesh.table if scene_mesh.technique == "variable_torque" else flanks.used[index],
        (driver.teeth, driven.teeth),
        (driver.base_radius, driven.base_radius),
        driver.base_helix_angle,
        float(flanks.law.damping[index]),
        float(flanks.law.reach[index]),
        float(system.phases.position[index]),
        scene_mesh.coast if index in flanks.coast else None,
    )
