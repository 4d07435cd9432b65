"""Oscillators of known motion: gears on springs, and their closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from dynamics.joints import ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import CoastFlank, GearMesh
from dynamics.meshes.technique import PlainTable
from dynamics.scene import Scene
from dynamics.shafts import GearBody, Inertia, Shaft
from dynamics.types import FloatArray

TEETH = 20
"""Number of teeth of both gears, of 4 mm module."""

BASE_RADIUS = 0.04 * math.cos(math.radians(20.0))
"""Base radius of both gears, m."""

STIFFNESS = 4e8
"""Mesh stiffness along the line of action, N/m."""

INERTIA = Inertia(1.0, 1e-3, 1e-3)
"""Mass, kg, polar and transverse moment of inertia, kg m^2, of each gear."""

MASS = INERTIA.polar / BASE_RADIUS**2
"""Moment of inertia as a mass on the line of action, kg."""

NATURAL = math.sqrt(STIFFNESS / MASS)
"""Natural frequency of the driven gear on its mesh, rad/s."""

RPM = math.pi / 30.0
"""1 rpm in rad/s."""

TORQUE = 100.0
"""Torque of the load, N m."""

DEFLECTION = TORQUE / BASE_RADIUS / STIFFNESS
"""Deflection of the mesh under that torque, m."""

_LEVEL = TORQUE / BASE_RADIUS
"""Mesh force under that torque, N: the upper level of the tables, which are linear in the force."""

POSITIONS = 64
"""Positions of a base pitch in the tables."""


def spring(amplitude: float = 0.0, positions: int = POSITIONS, stiffness: float = STIFFNESS) -> PlainTable:
    """Return the table F = stiffness (d - amplitude cos 2 pi x) in contact; amplitude in m."""
    x = np.arange(positions) / positions
    error = amplitude * np.cos(2.0 * np.pi * x)
    slope = -2.0 * np.pi * amplitude * np.sin(2.0 * np.pi * x)
    levels = np.array([0.0, _LEVEL])
    return _table(x, levels, error[:, None] + levels / stiffness, slope[:, None], stiffness, 0.0)


def changing_spring(ratio: float, positions: int = 256, mean: float = STIFFNESS) -> PlainTable:
    """Return F = k(x) d, k a cosine about `mean` whose highest value is `ratio` times its lowest."""
    x = np.arange(positions) / positions
    swing = (ratio - 1.0) / (ratio + 1.0)
    k = mean * (1.0 + swing * np.cos(2.0 * np.pi * x))
    k_slope = -2.0 * np.pi * mean * swing * np.sin(2.0 * np.pi * x)
    levels = np.array([0.0, _LEVEL])
    deflection = levels / k[:, None]
    return _table(x, levels, deflection, -deflection * (k_slope / k)[:, None], k[:, None], k_slope[:, None])


def coast(backlash: float, amplitude: float = 0.0, positions: int = POSITIONS) -> CoastFlank:
    """Return the backs of the teeth of `spring`: they touch at d = amplitude cos 2 pi x - backlash."""
    return CoastFlank(backlash, 0.0, spring(-amplitude, positions))


def torsional(
    mesh: PlainTable | None = None,
    *,
    speed: TimeLaw | float = 900.0 * RPM,
    torque: TimeLaw | float = TORQUE,
    duration: float = 0.05,
    back: CoastFlank | None = None,
    damping: float = 0.0,
    **changes: Any,
) -> Scene:
    """Return the scene with one freedom; speed in rad/s, torque in N m against it, damping in N s/m."""
    gears = tuple(
        GearBody(f"gear {k}", f"shaft {k}", 0.0, TEETH, BASE_RADIUS, 0.025, inertia=INERTIA) for k in (1, 2)
    )
    shafts = (Shaft("shaft 1", 0.2), Shaft("shaft 2", 0.2, (0.08, 0.0, 0.0)))
    table = mesh or spring()
    return Scene(
        shafts,
        gears,
        (GearMesh("mesh", "gear 1", "gear 2", table, damping=damping, coast=back),),
        (ImposedRotation("drive", "shaft 1", _law(speed)),),
        duration,
        loads=(LoadTorque("load", "shaft 2", _law(torque)),),
        effects={} if back is None else {"backlash": "on"},
        **changes,
    )


def damping_of(ratio: float) -> float:
    """Return the damping in N s/m of a damping ratio of the driven gear on its mesh."""
    return 2.0 * ratio * math.sqrt(STIFFNESS * MASS)


def _law(value: TimeLaw | float) -> TimeLaw:
    return value if isinstance(value, TimeLaw) else TimeLaw.constant(value)


def _table(
    position: FloatArray,
    level: FloatArray,
    deflection: FloatArray,
    deflection_slope: FloatArray,
    stiffness: FloatArray | float,
    stiffness_slope: FloatArray | float,
) -> PlainTable:

    def spread(values: FloatArray | float) -> FloatArray:
        return np.broadcast_to(np.asarray(values, float), (position.size, level.size))[None, None].copy()

    return PlainTable(
        position=position,
        level=level,
        misalignment=np.zeros(1),
        center_distance_change=np.zeros(1),
        deflection=spread(deflection),
        deflection_slope=spread(deflection_slope),
        stiffness=spread(stiffness),
        stiffness_slope=spread(stiffness_slope),
    )
