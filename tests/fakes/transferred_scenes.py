"""A helical two-stage unit of elastic shafts on rolling bearings in a sounding housing, and other flanks."""

from dataclasses import replace
from functools import cache

import numpy as np
from hulls import box
from reduced_housings import bare_housing
from sliced_face import sliced_database
from sounding_housings import part_of_scene, smooth_motion, with_surface
from two_stage_scenes import two_stages
from varied_housing import plane_waves
from warm_scenes import ANGULAR, TAPERED, mirrored

from dynamics.bearings import RollingBearing
from dynamics.housings.reduced_housing import PointMotion
from dynamics.noise import SoundModel
from dynamics.scene import Scene

SPEEDS = np.array([40.0, 130.0, 210.0, 360.0, 700.0])
NAMES = tuple(f"{shaft}.{end}" for shaft in ("in", "mid", "out") for end in ("left", "right"))
EFFECTS = dict.fromkeys(("dynamic_misalignment", "moving_application_point", "housing_modes"), "on")


@cache
def table():
    """Of flanks that follow a misalignment, their load in the middle of the face where there is none."""
    return sliced_database().force_table()


@cache
def far_table():
    """Of flanks that ripple by other harmonics, are a fifth stiffer, and carry off the middle of the face."""
    own = table()
    wave = 0.8 + 0.1 * np.sin(2.0 * np.pi * own.position) + 0.05 * np.cos(6.0 * np.pi * own.position)
    slope = (
        2.0 * np.pi * (0.1 * np.cos(2.0 * np.pi * own.position) - 0.15 * np.sin(6.0 * np.pi * own.position))
    )
    wave, slope = wave[:, None], slope[:, None]
    return replace(
        own,
        deflection=own.deflection * wave,
        deflection_slope=own.deflection_slope * wave + own.deflection * slope,
        stiffness=own.stiffness / wave,
        stiffness_slope=own.stiffness_slope / wave - own.stiffness * slope / wave**2,
        deflection_derivative=None,
        stiffness_derivative=None,
        load_arm=own.load_arm + 3e-3 + 1e-3 * np.sin(2.0 * np.pi * own.position)[:, None],
    )


def unit(first=None, second=None, rolling: bool = True) -> Scene:
    scene = two_stages(table(), effects=EFFECTS, torque=300.0)
    meshes = zip(scene.meshes, (first or table(), second or table()), strict=True)
    scene = replace(scene, meshes=tuple(replace(mesh, table=own) for mesh, own in meshes))
    if rolling:
        rows = (ANGULAR, mirrored(ANGULAR), *(TAPERED, mirrored(TAPERED)) * 2)
        parts = zip(scene.bushings, rows, strict=True)
        bearings = (
            RollingBearing(bush.name, bush.shaft, row, bush.position, np.sign(row.contact_angle) * 300.0)
            for bush, row in parts
        )
        scene = replace(scene, bushings=(), rolling_bearings=tuple(bearings))
    return replace(scene, housings=(part_of_scene(housing()),))


@cache
def housing():
    bare, hull = bare_housing(NAMES), box((0.36, 0.24, 0.18), (9, 6, 5))
    motion = smooth_motion(hull, len(bare.stiffness))
    top = PointMotion("top", hull.nodes[0], motion[0])
    return replace(with_surface(bare, hull, motion), points=(top,))


def sound_model(scene: Scene) -> SoundModel:
    return SoundModel(scene, {"case": housing()}, {"case": plane_waves(housing(), 5.0, 2e5)})
