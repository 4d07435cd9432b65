"""A gear pair whose bearings sit in a tube, reduced from its mesh, bolted to the ground or on a mount."""

from dataclasses import replace

import numpy as np
from geared_scenes import gear_pair_scene
from lattice_meshes import tube
from sounding_housings import part_of_scene

from dynamics.housings import (
    Bore,
    Foot,
    Material,
    MeshedHousing,
    Mount,
    Plane,
    ReducedHousing,
    SeatBore,
    reduced_housing,
)
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.schemas.scene import SceneInput

BEARINGS = ("input.left", "output.left")
SEATS = tuple(
    SeatBore(name, Bore((0.0, 0.0, z), (0.0, 0.0, toward), 0.08, 0.05))
    for name, z, toward in zip(BEARINGS, (0.075, 0.025), (1.0, -1.0), strict=True)
)
FLOOR = Plane((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
ON = {"lateral": "on", "axial": "on", "tilt": "on", "housing_modes": "on"}
OFF = ON | {"housing_modes": "off"}


def tube_on(mount: Mount | None) -> ReducedHousing:
    """A tube under two bearings, its lower bore pointing down, bolted to the ground or on a mount."""
    mesh = tube(0.12, 0.08, 0.1, (8, 1, 4))
    return reduced_housing(
        MeshedHousing(mesh, Material(210e9, 0.3, 7850.0), SEATS, (Foot("base", FLOOR, mount),), modes=6)
    )


def mount_of(stiffness: float) -> Mount:
    """N/m along the axes; about them as for a lever of 0.1 m."""
    matrix = stiffness * np.diag([1.0, 1.0, 1.0, 1e-2, 1e-2, 1e-2])
    return Mount(tuple(map(tuple, matrix.tolist())), tuple(map(tuple, (1e-5 * matrix).tolist())))


def subject_of(housing: ReducedHousing, effects: dict[str, str] = ON) -> TabledScene:
    scene = replace(gear_pair_scene(), housings=(part_of_scene(housing),), effects=effects)
    written = SceneInput.model_construct(meshes=(), rolling_bearings=())
    return TabledScene(written, {}, scene, {"case": housing})
