"""Gear stages in a row: pairs of the example's gears, each driven through a coupling by the one before."""

from __future__ import annotations

import math

from dynamics.bearings import Bushing
from dynamics.joints import Coupling, ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import GearMesh
from dynamics.meshes.mesh_table import MeshTable
from dynamics.scene import Outputs, Scene
from dynamics.shafts import GearBody, Shaft, hollow_cylinder

TEETH, RADIUS, FACE, LENGTH, GAP = 20, 0.040, 0.025, 0.2, 0.05
BASE_RADIUS = RADIUS * math.cos(math.radians(20.0))
GEAR = hollow_cylinder(2.0 * RADIUS, FACE, 0.04)
SHAFT = hollow_cylinder(0.04, LENGTH)
STIFF = 1e6  # N m/rad: of the drive, which leaves the first shaft its rotation, and of the couplings
ALL_FREE = {"lateral": "on", "axial": "on", "tilt": "on"}


def stages(
    table: MeshTable,
    count: int,
    duration: float,
    speed: TimeLaw,
    outputs: Outputs | None = None,
    gear_at: float = 0.08,
) -> Scene:
    """Return `count` stages: two shafts of six freedoms, four bushings and one mesh each, all at 100 N m.

    Shafts lie 80 mm apart and stages behind each other; gears sit off the middle, so that shafts tilt.
    """
    names = tuple(f"{side} {stage}" for stage in range(count) for side in ("input", "output"))
    return Scene(
        tuple(_shaft(name, index) for index, name in enumerate(names)),
        tuple(GearBody(name, name, gear_at, TEETH, BASE_RADIUS, FACE, inertia=GEAR) for name in names),
        tuple(
            GearMesh(f"mesh {stage}", *names[2 * stage : 2 * stage + 2], table, damping_ratio=0.15)
            for stage in range(count)
        ),
        (ImposedRotation("motor", names[0], speed, stiffness=STIFF, damping=10.0),),
        duration,
        tuple(
            Bushing(f"{name} {end}", name, at, 1e8, 1e8)
            for name in names
            for end, at in (("left", 0.0), ("right", LENGTH))
        ),
        (LoadTorque("brake", names[-1], TimeLaw.constant(100.0)),),
        couplings=tuple(
            Coupling(f"coupling {stage}", names[2 * stage - 1], names[2 * stage], STIFF, 10.0)
            for stage in range(1, count)
        ),
        effects=ALL_FREE,
        outputs=outputs or Outputs(),
    )


def _shaft(name: str, index: int) -> Shaft:
    """Return a shaft: pairs side by side, stages behind each other on common axes."""
    place = (2.0 * RADIUS * ((index + 1) // 2), 0.0, index // 2 * (LENGTH + GAP))
    return Shaft(name, LENGTH, place, SHAFT)
