"""Scenes whose motion carries errors on (impacts, reversals, light damping), and others that forget them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

from dynamics.joints import FreeRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes.gear_mesh import CoastFlank
from dynamics.meshes.mesh_table import MeshTable
from dynamics.scene import Integration, Outputs, Scene, pair_scene
from dynamics.shafts import GearBody, hollow_cylinder
from lineofaction.hardcases.dynamics.oscillators import (
    BASE_RADIUS,
    NATURAL,
    RPM,
    TEETH,
    TORQUE,
    changing_spring,
    coast,
    damping_of,
    spring,
    torsional,
)

TOLERANCE = 1e-9
RESONANCE = NATURAL / TEETH
"""rad/s, of the drive, at which teeth mesh with the natural frequency of `torsional`."""


def _hammering() -> Scene:
    """A light load, waves as large as the gap and little damping: impacts on both flanks."""
    return torsional(
        spring(12e-6),
        torque=10.0,
        speed=0.6 * RESONANCE,
        back=coast(20e-6, 12e-6),
        damping=damping_of(0.02),
        duration=0.1,
    )


def _rattle() -> Scene:
    return torsional(
        spring(15e-6),
        torque=0.0,
        speed=6000.0 * RPM,
        back=coast(20e-6, 15e-6),
        damping=damping_of(0.3),
        duration=0.05,
    )


def _chaotic_rattle() -> Scene:
    return torsional(
        spring(30e-6),
        torque=0.0,
        speed=1000.0 * RPM,
        back=coast(20e-6, 30e-6),
        damping=damping_of(0.1),
        duration=0.3,
    )


def _reversal(ratio: float, ramp: float) -> Scene:
    """The load reverses within `ramp` s and takes the teeth through the gap, damped by `ratio`."""
    torque = TimeLaw((0.0, 0.01, 0.01 + ramp), (TORQUE, TORQUE, -TORQUE))
    return torsional(torque=torque, back=coast(20e-6), damping=damping_of(ratio), duration=0.03 + ramp)


def _lift_off(ratio: float, mean: float = 1.5e-6) -> Scene:
    """Teeth part near the resonance, with nothing behind them."""
    return torsional(spring(mean), speed=0.95 * RESONANCE, damping=damping_of(ratio), duration=0.1)


def _run_up_with_lift_off() -> Scene:
    return torsional(
        spring(1.5e-6, 256),
        speed=TimeLaw.ramp(0.5 * RESONANCE, 1.3 * RESONANCE, 0.2),
        damping=damping_of(0.05),
        duration=0.2,
    )


def _undamped_step() -> Scene:
    """A torque step rings on for ever, in contact."""
    return torsional(torque=TimeLaw.ramp(TORQUE, 1.5 * TORQUE, 1e-4, begin=1e-3), duration=0.1)


def _light_damping(ratio: float) -> Scene:
    """Waves of the teeth off the resonance, in contact throughout."""
    return torsional(spring(0.3e-6), speed=0.45 * RESONANCE, damping=damping_of(ratio), duration=0.2)


def _varying_stiffness() -> Scene:
    return torsional(changing_spring(1.5), speed=0.7 * RESONANCE, damping=damping_of(0.004), duration=0.2)


def _free_train() -> Scene:
    """Two gears between motor and brake, that reverse."""
    reversal = (0.0, 0.01, 0.02)
    scene = torsional(
        spring(1e-6),
        torque=TimeLaw(reversal, (TORQUE, TORQUE, -TORQUE)),
        back=coast(15e-6, 1e-6),
        damping=damping_of(0.05),
        duration=0.06,
    )
    motor = LoadTorque("motor", "shaft 1", TimeLaw(reversal, (-TORQUE, -TORQUE, TORQUE)))
    return replace(
        scene,
        drives=(),
        free_rotations=(FreeRotation("train", "shaft 1", 50.0),),
        loads=(motor, *scene.loads),
    )


def pair_on_bearings(table: MeshTable, speed: TimeLaw, torque: TimeLaw, duration: float) -> Scene:
    """Return a pair of 20 teeth on shafts in elastic bearings, twelve freedoms."""
    driver, driven = (
        GearBody(name, shaft, 0.1, TEETH, BASE_RADIUS, 0.025, inertia=hollow_cylinder(0.08, 0.025, 0.04))
        for name, shaft in (("driver", "input"), ("driven", "output"))
    )
    return pair_scene(
        table,
        (driver, driven),
        center_distance=0.08,
        shaft_inertia=hollow_cylinder(0.04, 0.2),
        speed=speed,
        resisting_torque=torque,
        duration=duration,
    )


def _spatial_reversal() -> Scene:
    torque = TimeLaw((0.0, 0.02, 0.03), (TORQUE, TORQUE, -TORQUE))
    scene = pair_on_bearings(spring(1e-6), TimeLaw.constant(900.0 * RPM), torque, 0.08)
    mesh = replace(scene.meshes[0], coast=CoastFlank(30e-6, 0.0, spring(-1e-6)))
    return replace(scene, meshes=(mesh,), effects={"backlash": "on"})


def _spatial_run_up(duration: float = 1.0) -> Scene:
    return pair_on_bearings(
        changing_spring(1.4), TimeLaw.ramp(0.0, 955.0 * RPM, 1.0), TimeLaw.constant(TORQUE), duration
    )


def _steady_pair() -> Scene:
    return pair_on_bearings(spring(0.5e-6), TimeLaw.constant(1500.0 * RPM), TimeLaw.constant(TORQUE), 0.5)


ACCUMULATING: Mapping[str, Callable[[], Scene]] = MappingProxyType(
    {
        "hammering": _hammering,
        "rattle": _rattle,
        "chaotic rattle": _chaotic_rattle,
        "torque reversal": lambda: _reversal(0.02, 0.002),
        "gentle reversal": lambda: _reversal(0.1, 0.02),
        "reversal of a pair on bearings": _spatial_reversal,
        "reversal of a free train": _free_train,
        "lift-off, damping 1 %": lambda: _lift_off(0.01),
        "lift-off in a run-up": _run_up_with_lift_off,
        "undamped torque step": _undamped_step,
        "damping 0.3 %": lambda: _light_damping(0.003),
        "varying stiffness, damping 0.4 %": _varying_stiffness,
    }
)
STEADY: Mapping[str, Callable[[], Scene]] = MappingProxyType(
    {
        "steady, damping 5 %": lambda: _light_damping(0.05),
        "steady, damping 2 %": lambda: _light_damping(0.02),
        "pair on bearings, constant speed": _steady_pair,
        "pair on bearings, run-up": _spatial_run_up,
    }
)


def scenes() -> dict[str, Scene]:
    """Return all scenes by name, at a tolerance of 1 nm, with points of the motion for samples."""
    made = {name: make() for name, make in {**ACCUMULATING, **STEADY}.items()}
    return {
        name: replace(
            scene,
            integration=Integration(tolerance=TOLERANCE),
            outputs=Outputs(scene.outputs.sample_rate, anti_alias=False),
        )
        for name, scene in made.items()
    }
