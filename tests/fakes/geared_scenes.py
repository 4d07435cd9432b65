"""Mesh-force tables in closed form and scenes on them, for the tests of dynamics.

`square_wave_table` has the trend of a spur pair: one pair in contact over 44 % of the pitch, two over the
rest, a deflection that grows with force^0.96 (20/20 pair in full contact: 0.963 from 10 to 100 N m, 0.954 to
400). `spring_table` is F = k (d - e(x)).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from dynamics import GearBody, Scene, TimeLaw, hollow_cylinder, pair_scene
from dynamics.meshes.mesh_table import FIELDS

NOMINAL_FORCE = 2660.0
BASE_RADIUS = 0.040 * math.cos(math.radians(20.0))
RPM = math.pi / 30.0


@dataclass(frozen=True)
class Table:
    position: np.ndarray
    level: np.ndarray
    misalignment: np.ndarray
    center_distance_change: np.ndarray
    deflection: np.ndarray
    deflection_slope: np.ndarray
    stiffness: np.ndarray
    stiffness_slope: np.ndarray
    period: int = 1


def _table(position, level, deflection, deflection_slope, stiffness, stiffness_slope):
    fields = [
        np.broadcast_to(np.asarray(a, float), (position.size, level.size))[None, None].copy()
        for a in (deflection, deflection_slope, stiffness, stiffness_slope)
    ]
    return Table(position, level, np.zeros(1), np.zeros(1), *fields)


def square_wave_table(positions=64):
    x = np.arange(positions) / positions
    level = np.array([0.0, 50.0, 133.0, 266.0, 532.0, 1330.0, 2660.0, 5320.0, 10640.0])
    edge = (np.cos(2 * np.pi * x) - math.cos(0.44 * math.pi)) / 0.12
    shape = 5.1e-6 + 2.65e-6 * 0.5 * (1.0 + np.tanh(edge))
    slope = -2.65e-6 * 0.5 / np.cosh(edge) ** 2 * 2 * np.pi * np.sin(2 * np.pi * x) / 0.12
    power = (level / NOMINAL_FORCE) ** 0.96
    deflection = shape[:, None] * power
    stiffness = np.zeros_like(deflection)
    stiffness[:, 1:] = level[1:] / (0.96 * deflection[:, 1:])
    return _table(
        x, level, deflection, slope[:, None] * power, stiffness, -stiffness * (slope / shape)[:, None]
    )


def repeated(table, period):
    """The same table, written out over `period` base pitches."""
    copies = {name: np.tile(getattr(table, name), (1, 1, period, 1)) for name in FIELDS}
    position = np.concatenate([table.position + pitch for pitch in range(period)])
    return replace(table, position=position, period=period, **copies)


def spring_table(stiffness, amplitude=0.0, positions=64, level=1.0):
    """F = stiffness (d - amplitude cos(2 pi x)), in contact only."""
    x = np.arange(positions) / positions
    levels = np.array([0.0, level])
    error = amplitude * np.cos(2 * np.pi * x)
    slope = -amplitude * 2 * np.pi * np.sin(2 * np.pi * x)
    return _table(x, levels, error[:, None] + levels / stiffness, slope[:, None], stiffness, 0.0)


def gear_pair_scene(
    table=None, *, speed=None, torque=100.0, duration=0.05, technique="variable_torque", **changes
):
    """The 20/20 pair of 4 mm module on 200 mm shafts; `changes` replace fields of the scene."""
    inertia = hollow_cylinder(0.08, 0.025, 0.04)
    pinion, wheel = (
        GearBody(name, shaft, 0.1, 20, BASE_RADIUS, 0.025, inertia=inertia)
        for name, shaft in (("pinion", "input"), ("wheel", "output"))
    )
    scene = pair_scene(
        table or square_wave_table(),
        (pinion, wheel),
        center_distance=0.08,
        shaft_inertia=hollow_cylinder(0.04, 0.2),
        speed=speed or TimeLaw.constant(900.0 * RPM),
        resisting_torque=TimeLaw.constant(torque),
        duration=duration,
    )
    return replace(with_mesh(scene, technique=technique), **changes)


def with_mesh(scene: Scene, **changes) -> Scene:
    return replace(scene, meshes=(replace(scene.meshes[0], **changes),))


def with_gear(scene: Scene, index: int, **changes) -> Scene:
    gears = list(scene.gears)
    gears[index] = replace(gears[index], **changes)
    return replace(scene, gears=tuple(gears))


def with_bushings(scene: Scene, **changes) -> Scene:
    return replace(scene, bushings=tuple(replace(bushing, **changes) for bushing in scene.bushings))
