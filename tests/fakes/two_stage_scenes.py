"""A helical two-stage gearbox with elastic shafts on linear bearings, for the tests of its deflection."""

import math
from dataclasses import replace

import numpy as np
from geared_scenes import spring_table

from dynamics.bearings import Bushing
from dynamics.joints import ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import GearMesh
from dynamics.scene import Scene
from dynamics.shafts import BeamSection, GearBody, Shaft, hollow_cylinder

HELIX = math.radians(12.0)  # at the base circle
ANGLE = math.radians(21.0)  # working pressure angle, of both stages
FACE = 0.03
DIAMETER = 0.035


def base_radius(teeth, module):
    """Of a gear whose operating pitch circle has this transverse module."""
    return 0.5 * module * teeth * math.cos(ANGLE)


def two_stages(table=None, hand=1.0, speed=150.0, torque=900.0, flexible=True, stiffness=2e8, **changes):
    """17/52 of module 2.5 mm and 19/61 of module 3.5 mm, the axes in a bent plane; torque on the output."""
    table = table or spring_table(4e8)
    stages = (("first", 17, 52, 0.0025, hand), ("second", 19, 61, 0.0035, -hand))
    names = (("p1", "in"), ("w1", "mid"), ("p2", "mid"), ("w2", "out"))
    position = {"p1": 0.06, "w1": 0.06, "p2": 0.13, "w2": 0.13}
    radii, gears, meshes = {}, [], []
    for k, (mesh, z1, z2, module, own) in enumerate(stages):
        for (name, shaft), teeth, side in zip(names[2 * k : 2 * k + 2], (z1, z2), (1.0, -1.0), strict=True):
            radii[name] = base_radius(teeth, module)
            inertia = hollow_cylinder(module * teeth, FACE, 0.0)
            gears.append(
                GearBody(
                    name, shaft, position[name], teeth, radii[name], FACE, side * own * HELIX, inertia=inertia
                )
            )
        meshes.append(GearMesh(mesh, names[2 * k][0], names[2 * k + 1][0], table))
    distance = [(radii["p1"] + radii["w1"]) / math.cos(ANGLE), (radii["p2"] + radii["w2"]) / math.cos(ANGLE)]
    mid = np.array([distance[0], 0.0, 0.0])
    out = mid + distance[1] * np.array([math.cos(0.6), math.sin(0.6), 0.0])
    origins = {"in": (0.0, 0.0, 0.0), "mid": tuple(map(float, mid)), "out": tuple(map(float, out))}
    section = (BeamSection(0.2, DIAMETER),) if flexible else ()
    own = {"sections": section} if flexible else {"inertia": hollow_cylinder(DIAMETER, 0.2)}
    shafts = tuple(Shaft(name, 0.2, origin, **own) for name, origin in origins.items())
    bushings = tuple(
        Bushing(f"{shaft}.{end}", shaft, z, stiffness, stiffness if end == "left" else 0.0)
        for shaft in origins
        for end, z in (("left", 0.01), ("right", 0.19))
    )
    scene = Scene(
        shafts=shafts,
        gears=tuple(gears),
        meshes=tuple(meshes),
        drives=(ImposedRotation("motor", "in", TimeLaw.constant(speed), position=0.0),),
        duration=0.1,
        bushings=bushings,
        loads=(LoadTorque("brake", "out", TimeLaw.constant(torque), 0.2),),
    )
    return replace(scene, **changes)


def mirrored_along(scene):
    """The scene mirrored end for end: every hand turns into the other, senses about z stay."""
    length = {shaft.name: shaft.length for shaft in scene.shafts}

    def other_end(parts):
        return tuple(replace(part, position=length[part.shaft] - part.position) for part in parts)

    gears = tuple(replace(gear, base_helix_angle=-gear.base_helix_angle) for gear in other_end(scene.gears))
    return replace(
        scene,
        gears=gears,
        bushings=other_end(scene.bushings),
        drives=other_end(scene.drives),
        loads=other_end(scene.loads),
        meshes=tuple(replace(mesh, misalignment=-mesh.misalignment) for mesh in scene.meshes),
    )


def mirrored_across(scene):
    """The scene mirrored in y: every hand turns into the other; its driving flanks are the others here."""
    shafts = tuple(
        replace(shaft, origin=(shaft.origin[0], -shaft.origin[1], shaft.origin[2])) for shaft in scene.shafts
    )
    gears = tuple(replace(gear, base_helix_angle=-gear.base_helix_angle) for gear in scene.gears)
    return replace(scene, shafts=shafts, gears=gears)
