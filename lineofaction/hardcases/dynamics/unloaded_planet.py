"""A planetary set of which one planet carries nothing."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dynamics.assembly.assemble import assemble
from dynamics.integrators import static_equilibrium
from dynamics.joints import ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.scene import Integration, PlanetarySet, Scene
from dynamics.shafts import Inertia
from lineofaction.hardcases.dynamics.laws import common_figures, run_both
from lineofaction.hardcases.dynamics.oscillators import spring
from lineofaction.hardcases.scene import Measured, Scenes, largest

SCENES = Scenes("dynamics")

# a published set, as the inertias
_PLANETS = 4
_TEETH = (28, 36, 100)  # of sun, planet and ring
_RADIUS_PER_TOOTH = 1.4e-3  # base radius over teeth, m
_STIFFNESS = 5e8  # of a mesh, N/m
_BEARING = 1e8  # stiffness of a planet's bearing, N/m
_ALPHA = math.radians(24.6)  # working pressure angle
_SUN_FORCE = 8000.0  # sum of the sun's mesh forces, N
_ERROR = 200e-6  # of one pin, m
_WAVE = 0.2e-6  # amplitude of the teeth's error, m


@SCENES.add(
    "one_planet_without_load",
    "A pin 0.2 mm back takes its planet out of both meshes: it turns as it likes, and its row of the "
    "stiffness matrix is zero.",
    "The others carry a third each; integrators agree, energy balances.",
)
def _one_without_load() -> Sequence[Measured]:
    """Set one pin back so far that its planet touches nothing, and run."""
    gears = _set()
    scene = _driven_scene(gears)
    start = static_equilibrium(assemble(scene))
    shares = start.mesh_force[::2] / _SUN_FORCE  # meshes with sun and ring alternate, planet by planet
    expected = np.array([0.0, *[1.0 / (_PLANETS - 1)] * (_PLANETS - 1)])
    runs = run_both(scene)
    mean = runs.implicit.mesh_force.mean(axis=1)
    off = np.abs(mean[2::2] / _SUN_FORCE - 1.0 / (_PLANETS - 1))
    return (
        Measured("equilibrium found", start.status.usable, minimum=1.0),
        Measured("shares at rest off 0, 1/3, 1/3, 1/3", largest(shares - expected), maximum=1e-6),
        *common_figures(runs, scene),
        Measured("force on the planet set back, N", runs.implicit.mesh_force[:2].max(), maximum=0.0),
        Measured("mean shares of the others off 1/3", off.max(), maximum=1e-4),
    )


def _set() -> PlanetarySet:
    """Return four planets between a sun and a ring in fixed bearings, the first pin set back."""
    radius = tuple(_RADIUS_PER_TOOTH * z for z in _TEETH)
    distance = (radius[0] + radius[1]) / math.cos(_ALPHA)
    table = spring(_WAVE, stiffness=_STIFFNESS)
    return PlanetarySet(
        teeth=_TEETH,
        base_radius=(radius[0], radius[1], radius[2]),
        center_distance=distance,
        face_width=0.025,
        sun_table=table,
        ring_table=table,
        planets=_PLANETS,
        sun_inertia=Inertia(0.4, 0.39 * radius[0] ** 2, 0.39 * radius[0] ** 2),
        planet_inertia=Inertia(0.66, 0.61 * radius[1] ** 2, 0.61 * radius[1] ** 2),
        ring_inertia=Inertia(2.35, 3.0 * radius[2] ** 2, 3.0 * radius[2] ** 2),
        carrier_inertia=Inertia(5.43, 6.29 * distance**2, 6.29 * distance**2),
        planet_stiffness=_BEARING,
        pin_errors=((0.0, _ERROR), *[(0.0, 0.0)] * (_PLANETS - 1)),
    )


def _driven_scene(gears: PlanetarySet) -> Scene:
    """Return the set with its sun driven, its ring held and its carrier loaded."""
    parts = gears.parts()
    ratio = 1.0 + gears.teeth[2] / gears.teeth[0]
    return Scene(
        shafts=parts.shafts,
        gears=parts.gears,
        meshes=parts.meshes,
        bushings=parts.bushings,
        planet_bearings=parts.planet_bearings,
        drives=(
            ImposedRotation("input", "sun", TimeLaw.constant(100.0)),
            ImposedRotation("ring held", "ring", TimeLaw.constant(0.0)),
        ),
        loads=(LoadTorque("brake", "carrier", TimeLaw.constant(ratio * _SUN_FORCE * gears.base_radius[0])),),
        duration=0.02,
        effects={"backlash": "off", "gyroscopic": "off"},
        integration=Integration(tolerance=1e-10),
    )
