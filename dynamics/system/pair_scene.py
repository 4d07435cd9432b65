"""The scene most runs start from: two gears, each in the middle of its shaft between two equal bushings."""

from __future__ import annotations

from dynamics.bodies import GearBody, Inertia, Shaft, TimeLaw
from dynamics.errors import InputError
from dynamics.forces import GearMesh, LoadTorque, MeshTable
from dynamics.joints import Bushing, ImposedRotation
from dynamics.system.scene import Scene

SHAFTS = ("input", "output")
GEARS = ("pinion", "wheel")


def pair_scene(
    table: MeshTable,
    *,
    teeth: tuple[int, int],
    base_radius: tuple[float, float],
    face_width: tuple[float, float],
    center_distance: float,
    gear_inertia: tuple[Inertia, Inertia],
    speed: TimeLaw,
    resisting_torque: TimeLaw,
    duration: float,
    base_helix_angle: float = 0.0,
    shaft_length: float = 0.2,
    shaft_inertia: Inertia | None = None,
    bushing_stiffness: float = 1e8,
    technique: str = "variable_torque",
) -> Scene:
    """Return the scene of a pair from its numbers, SI; (driver, driven) in tuples.

    The driver's shaft "input" lies on the z axis from z = 0, the driven "output" beside it at x =
    `center_distance`. `speed` (rad/s about +z) is imposed on the first, `resisting_torque` (N m) loads the
    second. The bushings "input.left", "input.right", "output.left", "output.right" at the shafts' ends have
    `bushing_stiffness` (N/m) radially and axially; `base_helix_angle` > 0 makes the driver right-handed.
    Change what else differs with `dataclasses.replace`.

    Raises
    ------
    InputError
        If a value cannot be used.
    """
    for name, pair in (("teeth", teeth), ("base_radius", base_radius), ("face_width", face_width)):
        if len(pair) != 2:
            raise InputError(name, pair, "two values: driver, driven")
    helix = (base_helix_angle, -base_helix_angle)
    gears = tuple(
        GearBody(
            GEARS[k],
            SHAFTS[k],
            shaft_length / 2.0,
            teeth[k],
            base_radius[k],
            face_width[k],
            helix[k],
            gear_inertia[k],
        )
        for k in range(2)
    )
    places = (0.0, center_distance)
    shafts = tuple(
        Shaft(name, shaft_length, (x, 0.0, 0.0), shaft_inertia or Inertia())
        for name, x in zip(SHAFTS, places, strict=True)
    )
    ends = (("left", 0.0), ("right", shaft_length))
    bushings = tuple(
        Bushing(f"{shaft}.{end}", shaft, along, bushing_stiffness, bushing_stiffness)
        for shaft in SHAFTS
        for end, along in ends
    )
    return Scene(
        shafts=shafts,
        gears=gears,
        meshes=(GearMesh("mesh", *GEARS, table, technique),),
        drives=(ImposedRotation("drive", SHAFTS[0], speed),),
        duration=duration,
        bushings=bushings,
        loads=(LoadTorque("load", SHAFTS[1], resisting_torque),),
    )
