"""Meshes at temperature: center distance, backlash, misalignment.

Gears grow with their temperature, and the axes move apart with that of the part that carries both shafts: the
housing, or the carrier of a planetary set. Strains are thermal: expansion coefficient times rise of
temperature.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from bounds import Quantity, Text, at_least, from_to
from dynamics.errors import InputError
from dynamics.mechanism.flank_gradients import misalignment_per_tilt
from dynamics.mechanism.kinematics import mesh_shafts, solve_kinematics
from dynamics.mechanism.line_of_action import UNIT_Z, line_of_action
from dynamics.mechanism.thermal_expansion import on_ground
from dynamics.meshes import GearMesh
from dynamics.scene.scene import Scene
from dynamics.shafts import Shaft
from dynamics.temperatures import Temperatures, WarmMesh
from dynamics.types import FloatArray


def warmed_meshes(scene: Scene) -> Scene:
    """Return the scene with its meshes at temperature.

    A scene without temperatures, or with meshes at temperature already, comes back as it is.

    Raises `InputError`: flanks bind, or the table does not reach the change of the center distance or the
    misalignment.
    """
    warm = scene.temperatures
    if warm is None or warm.meshes is not None:
        return scene
    changes = tuple(_warm_mesh(scene, warm, index) for index in range(len(scene.meshes)))
    meshes = []
    for index, (mesh, change) in enumerate(zip(scene.meshes, changes, strict=True)):
        try:
            meshes.append(_at_temperature(mesh, change))
        except InputError as error:
            raise error.within(f"meshes[{index}]") from None
    return replace(scene, meshes=tuple(meshes), temperatures=replace(warm, meshes=changes))


def _at_temperature(mesh: GearMesh, change: WarmMesh) -> GearMesh:
    coast = mesh.coast
    if coast is not None:
        backlash = coast.backlash + change.backlash
        if backlash < 0.0:
            remedy = Text.of("The temperatures take ", Quantity(-change.backlash, "m"), ".")
            raise InputError("coast.backlash", backlash, at_least(0.0, "m", note=" at temperature"), remedy)
        coast = replace(coast, backlash=backlash)
    return replace(
        mesh,
        coast=coast,
        center_distance_change=_along_axis(mesh, "center_distance_change", change.distance_change),
        misalignment=_along_axis(mesh, "misalignment", change.misalignment),
    )


def _along_axis(mesh: GearMesh, name: str, shift: float) -> float:
    """Return the operating point of a mesh on an axis of its table, shifted if the table has this axis.

    A table without the axis has a single knot.
    """
    value, knots = float(getattr(mesh, name)), np.asarray(getattr(mesh.table, name), dtype=float)
    if knots.size == 1:
        return value
    if not knots[0] <= value + shift <= knots[-1]:
        bound = from_to(float(knots[0]), float(knots[-1]), "m")
        raise InputError(name, value + shift, bound, "Widen this axis of the table to the temperatures.")
    return value + shift


def _warm_mesh(scene: Scene, warm: Temperatures, index: int) -> WarmMesh:
    """Return the changes of a mesh by temperatures.

    Let s be -1 for the pinion in a ring gear and +1 for other gears, r operating pitch radii, e the strain of
    the gears, e_h that of the part that carries the shafts, and a the center distance. A warm pair meshes
    like the cold pair with axes g = e_h a - sum(s r e) farther apart. Backlash changes by 2 sin(alpha_wt) g,
    half of it at each flank.
    """
    mesh = scene.meshes[index]
    gears = scene.gear(mesh.driver), scene.gear(mesh.driven)
    shafts = [scene.shaft(gear.shaft) for gear in gears]
    distance = math.dist(shafts[0].origin[:2], shafts[1].origin[:2])
    internal = any(gear.internal for gear in gears)
    signs = [-1.0 if internal and not gear.internal else 1.0 for gear in gears]
    base_sum = sum(sign * gear.base_radius for sign, gear in zip(signs, gears, strict=True))
    # base_sum is a cos(alpha_wt)
    if not 0.0 < base_sum < distance:
        return WarmMesh(0.0, 0.0, 0.0)  # no pair: the mechanism says so
    strains = [warm.strain(gear.thermal_expansion, gear.temperature) for gear in gears]
    radii = [sign * gear.base_radius * distance / base_sum for sign, gear in zip(signs, gears, strict=True)]
    strain, slope = _wall_strain(scene, warm, index)
    growth = distance * strain - sum(r * e for r, e in zip(radii, strains, strict=True))
    backlash = 2.0 * math.sqrt(1.0 - (base_sum / distance) ** 2) * growth * (-1.0 if internal else 1.0)
    return WarmMesh(growth, backlash, _misaligned(scene, index, slope))


def _wall_strain(scene: Scene, warm: Temperatures, index: int) -> tuple[float, float]:
    """Return the strain of the part that carries both shafts of a mesh, and its slope along z, 1/m.

    A carrier has the strain of its shaft. The strain of the housing is linear along each shaft, fitted to its
    bearing seats; the mesh has the mean of both shafts.
    """
    driver, driven, carrier = mesh_shafts(scene, index)
    if carrier is not None:
        shaft = scene.shafts[carrier]
        return warm.strain(shaft.thermal_expansion, shaft.temperature), 0.0
    mesh = scene.meshes[index]
    lines = [
        _along(scene, warm, scene.shafts[shaft], scene.gear(name).position)
        for shaft, name in ((driver, mesh.driver), (driven, mesh.driven))
    ]
    strain, slope = np.mean(lines, axis=0)
    return float(strain), float(slope)


def _along(scene: Scene, warm: Temperatures, shaft: Shaft, position: float) -> tuple[float, float]:
    """Return the strain of the housing at a position along a shaft (m), and its slope, 1/m."""
    bearings = on_ground(scene, shaft.name)
    strain = [warm.housing_strain(part.seat_temperature) for part in bearings] or [warm.housing_strain()]
    positions = [part.position for part in bearings] or [position]
    if np.ptp(strain) == 0.0 or np.ptp(positions) == 0.0:
        return float(np.mean(strain)), 0.0
    slope, strain_at_position = np.polyfit(np.subtract(positions, position), strain, 1)
    return float(strain_at_position), float(slope)


def _misaligned(scene: Scene, index: int, slope: float) -> float:
    """Return the misalignment of axes whose distance grows by its part `slope` (1/m) along z, m."""
    if slope == 0.0:
        return 0.0
    sense = solve_kinematics(scene).mesh_sense[index]
    line, mesh = line_of_action(scene, index, sense), scene.meshes[index]
    first, second = (scene.shaft(scene.gear(name).shaft).origin for name in (mesh.driver, mesh.driven))
    offset: FloatArray = np.subtract(second, first) * np.array([1.0, 1.0, 0.0])
    tilt = slope * np.cross(UNIT_Z, offset)
    return -float(tilt @ misalignment_per_tilt(scene, index, line, sense))
