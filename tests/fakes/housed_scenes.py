"""Gear pairs and blocks in housings with mass."""

from dataclasses import replace

import numpy as np
from geared_scenes import gear_pair_scene, spring_table, with_gear

from dynamics import Bushing, Coupling, Housing, Inertia, Shaft, TimeLaw

ON = {"lateral": "on", "axial": "on", "tilt": "on", "housing_modes": "on"}
OFF = ON | {"housing_modes": "off"}
NAMES = ("input.left", "input.right", "output.left", "output.right")
STIFFNESS, MASS, GROUND, BLOCK = 1e6, 2.0, 2e6, 4.0


def rows(matrix):
    return tuple(tuple(float(value) for value in row) for row in np.asarray(matrix))


def definite(size, seed, scale):
    """A well-conditioned positive definite matrix without zeros."""
    factor = np.random.default_rng(seed).normal(size=(size, size))
    return scale * (factor @ factor.T / size + 0.5 * np.eye(size))


def matrices(per, modal=0):
    """Stiffness, damping, mass of a housing under all four bearings; tilts by a lever of 0.1 m."""
    lever = np.tile([1.0, 1.0, 1.0, 0.1, 0.1, 0.1][:per], len(NAMES))
    unit = np.concatenate([lever, np.ones(modal)])
    sizes = ((1, 3e8), (2, 3e3), (3, 4.0))
    return [np.outer(unit, unit) * definite(unit.size, seed, scale) for seed, scale in sizes]


def housed(scene, per=5, modal=0, **changes):
    stiffness, damping, mass = matrices(per, modal)
    fields = {"damping": rows(damping), "mass": rows(mass), "modal_coordinates": modal} | changes
    return replace(scene, housings=(Housing("case", NAMES, rows(stiffness), **fields),))


def pair(effects=ON, **changes):
    """The pair with its gears off the middle of their shafts, so that these tilt."""
    scene = gear_pair_scene(spring_table(4e8), effects=effects, **changes)
    return with_gear(with_gear(scene, 0, position=0.06), 1, position=0.06)


def block(contacts=(), bearings=(), *, radial=STIFFNESS, ratio=0.02, force=(), effects=ON, **changes):
    """A disc on one bearing in a block on springs, turned through a soft coupling by the pair's driver."""
    speed = changes.pop("speed", 10.0)
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.constant(speed), effects=effects)
    shaft = Shaft("disc", 0.2, (0.0, 0.0, 0.4), Inertia(MASS, 0.02, 0.01))
    bushings = (
        (*scene.bushings, Bushing("seat", "disc", 0.1, radial, radial)) if not bearings else scene.bushings
    )
    return replace(
        scene,
        shafts=(*scene.shafts, shaft),
        bushings=bushings,
        couplings=(Coupling("joint", "input", "disc", 100.0),),
        housings=(
            Housing(
                "case",
                ("seat",),
                rows(GROUND * np.eye(3)),
                mass=rows(BLOCK * np.eye(3)),
                damping_ratio=ratio,
            ),
        ),
        rolling_contacts=contacts,
        rolling_bearings=bearings,
        forces=force,
        **changes,
    )
