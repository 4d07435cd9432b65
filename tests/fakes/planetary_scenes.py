"""Planetary sets on linear mesh springs, for the tests of dynamics.

`published_set` is the example of J. Lin and R. G. Parker, "Analytical characterization of the unique
properties of planetary gear free vibration", Journal of Vibration and Acoustics 121 (1999), 316-321: masses,
inertias over radius squared, stiffnesses and pressure angle. Radii drop out of its equations; here they
follow from tooth numbers that can be assembled.
"""

import math
from dataclasses import replace

from geared_scenes import spring_table

from dynamics import FreeRotation, ImposedRotation, Inertia, LoadTorque, PlanetarySet, Scene, TimeLaw

PRESSURE_ANGLE = math.radians(24.6)
MESH_STIFFNESS = 5e8
BEARING_STIFFNESS = 1e8
TEETH = {3: (27, 36, 99), 4: (28, 36, 100), 5: (30, 35, 100)}
RADIUS_PER_TOOTH = 1.4e-3


def published_set(planets: int, **changes) -> PlanetarySet:
    """The published set of 3, 4 or 5 planets, all members on bearings of the same stiffness."""
    teeth = changes.pop("teeth", TEETH.get(planets, TEETH[3]))
    radius = tuple(RADIUS_PER_TOOTH * z for z in teeth)
    distance = (radius[0] + radius[1]) / math.cos(PRESSURE_ANGLE)

    def inertia(mass, polar_over_square, r):
        return Inertia(mass, polar_over_square * r**2, polar_over_square * r**2)

    given = {
        "teeth": teeth,
        "base_radius": radius,
        "center_distance": distance,
        "face_width": 0.025,
        "sun_table": spring_table(MESH_STIFFNESS),
        "ring_table": spring_table(MESH_STIFFNESS),
        "planets": planets,
        "sun_inertia": inertia(0.40, 0.39, radius[0]),
        "planet_inertia": inertia(0.66, 0.61, radius[1]),
        "ring_inertia": inertia(2.35, 3.00, radius[2]),
        "carrier_inertia": inertia(5.43, 6.29, distance),
        "sun_stiffness": BEARING_STIFFNESS,
        "ring_stiffness": BEARING_STIFFNESS,
        "carrier_stiffness": BEARING_STIFFNESS,
        "planet_stiffness": BEARING_STIFFNESS,
        "ring_phase": 0.0,
    }
    return PlanetarySet(**{**given, **changes})


def planetary_scene(
    gears: PlanetarySet, *, sun_torque=500.0, duration=0.02, ring_support=None, speed=100.0, **changes
) -> Scene:
    """The sun driven by a torque and braked at the carrier, or (`drives` given) as stated; the ring held."""
    parts = gears.parts()
    ratio = 1.0 + gears.teeth[2] / gears.teeth[0]
    held = ImposedRotation("ring held", "ring", TimeLaw.constant(0.0), ring_support)
    free = {
        "drives": (held,),
        "free_rotations": (FreeRotation("input", "sun", speed),),
        "loads": (
            LoadTorque("motor", "sun", TimeLaw.constant(-sun_torque)),
            LoadTorque("brake", "carrier", TimeLaw.constant(ratio * sun_torque)),
        ),
    }
    return Scene(
        shafts=parts.shafts,
        gears=parts.gears,
        meshes=parts.meshes,
        bushings=parts.bushings,
        planet_bearings=parts.planet_bearings,
        duration=duration,
        **{**free, **changes},
    )


def driven_scene(gears: PlanetarySet, *, speed=None, torque=2000.0, **changes) -> Scene:
    """The sun's speed imposed, the ring held, the carrier loaded."""
    scene = planetary_scene(gears)
    held = scene.drives[0]
    sun = ImposedRotation("input", "sun", speed or TimeLaw.constant(100.0))
    load = LoadTorque("brake", "carrier", TimeLaw.constant(torque))
    return replace(scene, drives=(sun, held), free_rotations=(), loads=(load,), **changes)
