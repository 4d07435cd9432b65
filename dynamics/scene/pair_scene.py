"""The scene most runs start from: two gears, each in the middle of its shaft between two equal bushings."""

from __future__ import annotations

from dynamics.bearings import Bushing
from dynamics.joints import ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import GearMesh, MeshTable
from dynamics.scene.scene import Scene
from dynamics.shafts import GearBody, Inertia, Shaft


def pair_scene(
    table: MeshTable,
    gears: tuple[GearBody, GearBody],
    *,
    center_distance: float,
    speed: TimeLaw,
    resisting_torque: TimeLaw,
    duration: float,
    shaft_inertia: Inertia | None = None,
    bushing_stiffness: float = 1e8,
) -> Scene:
    """Return the scene of a pair: a shaft with imposed speed, and one with a resisting torque.

    The driver's shaft lies on the z axis from z = 0, the driven shaft beside it at x = `center_distance`.
    Both have their gear at mid-length. The mesh is named "mesh", the drive "drive", the load "load". Change
    other fields with `dataclasses.replace`. Raises `InputError`: a value cannot be used.

    Parameters
    ----------
    table : MeshTable
        Table of the mesh, for instance `SteDatabase.force_table()`.
    gears : (GearBody, GearBody)
        Driver and driven, on shafts of their own.
    center_distance : float
        m.
    speed : TimeLaw
        Imposed on the driver's shaft, rad/s about +z.
    resisting_torque : TimeLaw
        Resisting torque on the driven shaft, N m.
    duration : float
        s.
    shaft_inertia : Inertia, optional
        Inertia of each shaft without its gear; default: none.
    bushing_stiffness : float
        Radial and axial, of the bushings "<shaft>.left" and "<shaft>.right" at the shafts' ends, N/m.
    """
    shafts = tuple(
        Shaft(gear.shaft, 2.0 * gear.position, (x, 0.0, 0.0), shaft_inertia or Inertia())
        for gear, x in zip(gears, (0.0, center_distance), strict=True)
    )
    bushings = tuple(
        Bushing(f"{shaft.name}.{end}", shaft.name, along, bushing_stiffness, bushing_stiffness)
        for shaft in shafts
        for end, along in (("left", 0.0), ("right", shaft.length))
    )
    driver, driven = gears
    return Scene(
        shafts=shafts,
        gears=gears,
        meshes=(GearMesh("mesh", driver.name, driven.name, table),),
        drives=(ImposedRotation("drive", driver.shaft, speed),),
        duration=duration,
        bushings=bushings,
        loads=(LoadTorque("load", driven.shaft, resisting_torque),),
    )
