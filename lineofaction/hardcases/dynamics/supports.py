"""Bearings that make a system stiff in the mathematical sense, or that hold nothing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dynamics.assembly.assemble import System, assemble
from dynamics.bearings import Bushing
from dynamics.forces import RollingContact
from dynamics.integrators import Trajectory, integrate, static_equilibrium
from dynamics.joints import Coupling
from dynamics.scene import Integration, Outputs, Scene
from dynamics.shafts import Inertia, Shaft
from dynamics.types import FloatArray
from lineofaction.hardcases.dynamics.bouncing_mass import bounce, cycle
from lineofaction.hardcases.dynamics.laws import METHODS, common_figures, rms, run_both
from lineofaction.hardcases.dynamics.oscillators import BASE_RADIUS, RPM, damping_of, spring, torsional
from lineofaction.hardcases.scene import Measured, Scenes, largest

SCENES = Scenes("dynamics")

_SOFT, _HARD = 1e5, 1e12
"""Stiffnesses of the unlike bushings, N/m."""
_TORQUE = 1.0
"""Torque on the shafts with unlike bushings, N m."""
_RIPPLE = 1e-8
"""Amplitude of the mesh's transmission error, m."""
_LENGTH = 0.2
"""Length of every shaft, m."""
_SHAFT = Inertia(mass=2.0, polar=1e-3, transverse=8e-3)
_DISC = Inertia(mass=2.0, polar=0.02, transverse=0.01)
_WALL = 5e8
"""Stiffness of the disc's bearing beyond its clearance, N/m."""
_CLEARANCE = 20e-6
"""Distance of the disc from the middle of its bearing to either side, m."""
_SPEED = 0.05
"""Speed at which the disc leaves a side of its bearing, m/s."""
_TOLERANCE = 1e-9
"""Tolerance of the integrators, m."""
_BOUNCES = 20
"""Impacts of the disc in a run."""


@SCENES.add(
    "bushings_1e5_and_1e12",
    "Stiffnesses seven decades apart in one matrix: natural motions of 0.03 s and of microseconds, and a "
    "shaft that all but pivots about one end.",
    "Each bushing carries half the load, gears move apart by F/2 (1/k1 + 1/k2); integrators agree, energy "
    "balances.",
)
def _unlike_bushings() -> Sequence[Measured]:
    """Hold shafts at one end by 1e5 and at the other by 1e12 N/m, free to tilt."""
    scene = _on_bushings()
    runs = run_both(scene)
    force = _TORQUE / BASE_RADIUS
    start_force = runs.implicit.bearing_force[:, :, 0]  # (bushing, direction x y z) at the first sample
    radial = np.hypot(start_force[:, 0], start_force[:, 1])
    system = assemble(scene)
    start = static_equilibrium(system)
    # the mesh force strains the bushings by its work over the distance s between the gears: F s = x' K x
    distance = float(start.displacement @ system.arrays.stiffness @ start.displacement) / force
    expected = force / 2.0 * (1.0 / _SOFT + 1.0 / _HARD)
    return (
        *common_figures(runs, scene),
        Measured("share of the load on a bushing, off 1/2", largest(radial / force - 0.5), maximum=1e-6),
        Measured("gears moved apart over the closed form, off one", abs(distance / expected - 1.0), 1e-6),
        Measured("steps, implicit", runs.implicit.statistics.accepted),
        Measured("steps, explicit", runs.explicit.statistics.accepted),
    )


def _on_bushings() -> Scene:
    """Return the pair in the middle of shafts on unlike bushings."""
    scene = torsional(
        spring(_RIPPLE), torque=_TORQUE, duration=0.02, damping=damping_of(0.05),
        integration=Integration(tolerance=1e-11),
    )  # fmt: skip
    shafts = tuple(replace(shaft, length=_LENGTH, inertia=_SHAFT) for shaft in scene.shafts)
    gears = tuple(replace(gear, position=_LENGTH / 2.0) for gear in scene.gears)
    bushings = tuple(
        Bushing(f"{shaft.name} {end}", shaft.name, at, stiffness, stiffness)
        for shaft in shafts
        for end, at, stiffness in (("soft", 0.0, _SOFT), ("hard", _LENGTH, _HARD))
    )
    effects = {"lateral": "on", "tilt": "on", "axial": "off"}
    return replace(scene, shafts=shafts, gears=gears, bushings=bushings, effects=effects)


@SCENES.add(
    "unloaded_in_clearance",
    "Nothing presses the disc against its bearing: within the clearance it has no stiffness and no place to "
    "rest.",
    "The closed form of flights and half sines between the walls, to one tolerance per impact; so does the "
    "energy.",
)
def _unloaded_in_clearance() -> Sequence[Measured]:
    """Throw an unloaded disc to and fro in the clearance of its bearing."""
    natural = math.sqrt(_WALL / _DISC.mass)
    duration = 0.5 * _BOUNCES * cycle(2.0 * _CLEARANCE, _SPEED, natural)
    # relative error of the speed by an error of one tolerance in the depth of an impact, _SPEED / natural
    speed_error = _TOLERANCE * natural / _SPEED
    # the flight after the k-th impact is off by k of these; over n impacts that is n^2 / 2 of them
    path_error = 2.0 * _CLEARANCE * speed_error * _BOUNCES**2 / 2.0
    paths, energies = [], []
    for method in METHODS:
        system = assemble(_disc(duration, Integration(method, _TOLERANCE)))
        run, path = _thrown_between_supports(system)
        paths.append(path)
        exact = _CLEARANCE + bounce(run.time, 2.0 * _CLEARANCE, _SPEED, natural)
        at_start, at_end = run.stored.sum(axis=1)
        energies.append((rms(path - exact), abs(float(at_end - at_start - run.work.sum()))))
    start = static_equilibrium(assemble(_disc(duration, Integration())))
    return (
        Measured("equilibrium of the unloaded disc found", start.status.usable, minimum=1.0),
        Measured(
            "two integrators apart, over a tolerance per impact and what flights make of it",
            rms(paths[0] - paths[1]) / (2.0 * path_error), maximum=1.0,
        ),
        Measured("off the closed form, likewise", max(off for off, _ in energies) / path_error, maximum=1.0),
        Measured(
            "energy lost over twenty impacts, over a tolerance per impact",
            max(loss for _, loss in energies) / (0.5 * _DISC.mass * _SPEED**2)
            / (2.0 * speed_error * _BOUNCES), maximum=1.0,
        ),
    )  # fmt: skip


def _disc(duration: float, integration: Integration) -> Scene:
    """Return a disc in one bearing with clearance, turned through a soft coupling by the driving gear."""
    outputs = Outputs(1e5)
    scene = torsional(spring(), speed=10.0 * RPM, duration=duration, outputs=outputs, integration=integration)
    return replace(
        scene,
        shafts=(*scene.shafts, Shaft("disc", _LENGTH, origin=(0.0, 0.0, 2.0 * _LENGTH), inertia=_DISC)),
        bushings=(Bushing("seat", "disc", _LENGTH / 2.0),),
        couplings=(Coupling("joint", "shaft 1", "disc", 100.0),),
        rolling_contacts=(RollingContact("seat", _WALL, exponent=1.0, clearance=_CLEARANCE, damping=0.0),),
        effects={"lateral": "on", "bearing_clearance": "on"},
    )


def _thrown_between_supports(system: System) -> tuple[Trajectory, FloatArray]:
    """Let the disc leave a side of its bearing at `_SPEED`; return the run and the disc's x over time, m."""
    start = static_equilibrium(system)
    across = system.freedoms.name.index("disc.x")
    displacement = start.displacement.copy()
    displacement[[n.startswith("disc.") and n[-1] in "xy" for n in system.freedoms.name]] = 0.0
    displacement[across] = _CLEARANCE
    velocity = np.zeros(displacement.size)
    velocity[across] = -_SPEED
    scene = system.scene
    run = integrate(system, replace(start, displacement=displacement), scene.integration, velocity=velocity)
    return run, run.q[:, across]
