"""A scene at its steady temperatures: the parts that it then has, in the place of those as drawn.

All parts expand freely and alike in all directions. Parts whose sizes matter to 1e-4 stay as drawn: lengths,
radii, base pitches. What is left are differences: play and axial force of bearings, center distance, backlash
and misalignment of meshes.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import accumulate

import numpy as np

from bounds import Quantity, Text, at_least, from_to
from dynamics.bearings import Bushing, RollingBearing
from dynamics.bearings.ring_fits import Cylinder, warm_rings
from dynamics.bearings.rolling_bearing import BallBearing
from dynamics.bearings.row_law import row_law
from dynamics.errors import InputError
from dynamics.mechanism.kinematics import mesh_shafts, solve_kinematics
from dynamics.mechanism.line_of_action import UNIT_Z, line_of_action, misalignment_per_tilt
from dynamics.meshes import GearMesh
from dynamics.scene.scene import Scene
from dynamics.shafts import Shaft
from dynamics.temperatures import Temperatures, WarmBearing, WarmMesh
from dynamics.types import FloatArray

# Bearings: the play of rows, and how far shafts outgrow the housing between their seats.


def warmed_bearings(scene: Scene) -> Scene:
    """Return `scene` with its bearings as temperatures leave them; itself if they are so or it has none.

    Raises `InputError`: a row or a curve of a bearing is none any more.
    """
    warm = scene.temperatures
    if warm is None or warm.bearings is not None:
        return scene
    rows = {}
    for index, bearing in enumerate(scene.rolling_bearings):
        try:
            rows[bearing.name] = _warm_row(scene, warm, bearing)
        except InputError as error:
            raise error.within(f"rolling_bearings[{index}]") from None
    growth = {part.name: _outgrown(scene, warm, part) for part in scene.bushings}
    return replace(
        scene,
        rolling_bearings=tuple(rows[part.name].warm for part in scene.rolling_bearings),
        bushings=tuple(_pushed(part, growth[part.name]) for part in scene.bushings),
        temperatures=replace(warm, bearings=rows),
    ).with_bearing_laws(lambda law: law.after_growth(growth.get(law.bushing, 0.0)))


def _warm_row(scene: Scene, warm: Temperatures, bearing: RollingBearing) -> WarmBearing:
    shaft, expansion = scene.shaft(bearing.shaft), bearing.thermal_expansion
    strain = (
        warm.strain(expansion, bearing.inner_temperature),
        warm.strain(expansion, bearing.outer_temperature),
    )
    walls = _seat(warm, shaft, bearing.position), _wall(warm, bearing)
    rings = warm_rings(bearing.row, bearing.fits, strain, *walls)
    shift = row_law(bearing).shift + _outgrown(scene, warm, bearing)
    try:
        row = replace(bearing.row, clearance=bearing.row.clearance + rings.play)
    except InputError as error:
        bound, advice = error.bound, "The temperatures change it by more than the row can have."
        name = "ball" if isinstance(bearing.row, BallBearing) else "roller"
        raise InputError(f"{name}.{error.field}", error.value, bound, advice) from None
    fits = zip(("inner ring", "outer ring"), rings.interference or (0.0, 0.0), strict=True)
    return WarmBearing(
        bearing,
        replace(bearing, row=row, axial_preload=0.0, axial_shift=shift),
        {name: -interference for name, interference in fits if interference < 0.0},
    )


def _seat(warm: Temperatures, shaft: Shaft, position: float) -> Cylinder:
    """Return the shaft in a bearing: solid steel where it has no sections."""
    strain = warm.strain(shaft.thermal_expansion, shaft.temperature)
    ends = accumulate(section.length for section in shaft.sections)
    under = [part for part, end in zip(shaft.sections, ends, strict=True) if position <= end]
    if not shaft.sections:
        return Cylinder(0.0, 1.0, strain=strain)
    own = under[0] if under else shaft.sections[-1]
    return Cylinder(own.bore_diameter, own.outer_diameter, own.youngs_modulus, own.poissons_ratio, strain)


def _wall(warm: Temperatures, bearing: RollingBearing) -> Cylinder:
    outer = bearing.fits.housing_diameter if bearing.fits else 1.0
    own, strain = warm.housing_material, warm.housing_strain(bearing.seat_temperature)
    return Cylinder(0.0, outer, own.youngs_modulus, own.poissons_ratio, strain)


def _outgrown(scene: Scene, warm: Temperatures, bearing: Bushing | RollingBearing) -> float:
    """Return how far the shaft moves along z against the housing at a bearing by their expansion, m.

    Where it is held along z it moves by nothing on the average: one bearing locates it, a pair shares.
    """
    own = _on_ground(scene, bearing.shaft)
    held = [part.position for part in own if _holds_axially(scene, part)]
    if not _holds_axially(scene, bearing) or len(held) < 2:
        return 0.0
    shaft = scene.shaft(bearing.shaft)
    housing = float(np.mean([warm.housing_strain(part.seat_temperature) for part in own]))
    strain = warm.strain(shaft.thermal_expansion, shaft.temperature) - housing
    return strain * (bearing.position - float(np.mean(held)))


def _on_ground(scene: Scene, shaft: str) -> list[Bushing | RollingBearing]:
    parts: tuple[Bushing | RollingBearing, ...] = (*scene.bushings, *scene.rolling_bearings)
    return [part for part in parts if part.shaft == shaft]


def _holds_axially(scene: Scene, bearing: Bushing | RollingBearing) -> bool:
    if isinstance(bearing, RollingBearing):
        rolls = not isinstance(bearing.row, BallBearing) and bearing.row.contact_angle == 0.0
        return bearing.locating != "none" and not rolls
    laws = [law for law in scene.scene_bearing_laws if law.bushing == bearing.name]
    return float(bearing.seat_stiffness[2, 2]) > 0.0 or any(law.holds_axially for law in laws)


def _pushed(bushing: Bushing, growth: float) -> Bushing:
    """Return a bushing whose shaft has grown by `growth` (m) along z: its springs push back as preload."""
    if growth == 0.0:
        return bushing
    force = np.zeros(5) if bushing.preload is None else np.array(bushing.preload)
    pushed = force - bushing.seat_stiffness[:, 2] * growth
    return replace(bushing, preload=tuple(float(value) for value in pushed))


# Meshes: center distance, backlash, misalignment.


def warmed_meshes(scene: Scene) -> Scene:
    """Return `scene` with its meshes as temperatures leave them; itself if they are so or it has none.

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
        left = coast.backlash + change.backlash
        if left < 0.0:
            advice = Text.of("The temperatures take ", Quantity(-change.backlash, "m"), ".")
            raise InputError("coast.backlash", left, at_least(0.0, "m", note=" at temperature"), advice)
        coast = replace(coast, backlash=left)
    return replace(
        mesh,
        coast=coast,
        center_distance_change=_along_axis(mesh, "center_distance_change", change.apart),
        misalignment=_along_axis(mesh, "misalignment", change.misalignment),
    )


def _along_axis(mesh: GearMesh, name: str, moved: float) -> float:
    """Return the operating point of a mesh along an axis of its table, moved if the table has the axis."""
    own, knots = float(getattr(mesh, name)), np.asarray(getattr(mesh.table, name), dtype=float)
    if knots.size == 1:
        return own
    if not knots[0] <= own + moved <= knots[-1]:
        bound = from_to(float(knots[0]), float(knots[-1]), "m")
        raise InputError(name, own + moved, bound, "Widen this axis of the table to the temperatures.")
    return own + moved


def _warm_mesh(scene: Scene, warm: Temperatures, index: int) -> WarmMesh:
    """Return what temperatures change of a mesh.

    With s = +1 for external gears and -1 for the pinion in a ring gear, and r their pitch radii, a warm pair
    meshes like the cold one whose axes are e_h a - sum(s r e) farther apart; each flank then yields by
    sin(alpha_wt) of that.
    """
    mesh = scene.meshes[index]
    gears = scene.gear(mesh.driver), scene.gear(mesh.driven)
    shafts = [scene.shaft(gear.shaft) for gear in gears]
    distance = math.dist(shafts[0].origin[:2], shafts[1].origin[:2])
    internal = any(gear.internal for gear in gears)
    signs = [-1.0 if internal and not gear.internal else 1.0 for gear in gears]
    acting = sum(sign * gear.base_radius for sign, gear in zip(signs, gears, strict=True))
    if not 0.0 < acting < distance:
        return WarmMesh(0.0, 0.0, 0.0)  # no pair: the mechanism says so
    grown = [warm.strain(gear.thermal_expansion, gear.temperature) for gear in gears]
    radii = [sign * gear.base_radius * distance / acting for sign, gear in zip(signs, gears, strict=True)]
    strain, slope = _wall_strain(scene, warm, index)
    apart = distance * strain - sum(r * e for r, e in zip(radii, grown, strict=True))
    backlash = 2.0 * math.sqrt(1.0 - (acting / distance) ** 2) * apart * (-1.0 if internal else 1.0)
    return WarmMesh(apart, backlash, _misaligned(scene, index, slope))


def _wall_strain(scene: Scene, warm: Temperatures, index: int) -> tuple[float, float]:
    """Return the strain of what carries both shafts of a mesh at its gears, and its derivative along z, 1/m.

    A carrier is as warm as its shaft. Of the housing it is linear along each shaft through its seats, and
    the mean of both shafts.
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
    own = _on_ground(scene, shaft.name)
    strain = [warm.housing_strain(part.seat_temperature) for part in own] or [warm.housing_strain()]
    at = [part.position for part in own] or [position]
    if np.ptp(strain) == 0.0 or np.ptp(at) == 0.0:
        return float(np.mean(strain)), 0.0
    slope, here = np.polyfit(np.subtract(at, position), strain, 1)
    return float(here), float(slope)


def _misaligned(scene: Scene, index: int, slope: float) -> float:
    """Return the misalignment of axes whose distance grows by its part `slope` (1/m) along z, m."""
    if slope == 0.0:
        return 0.0
    sense = solve_kinematics(scene).mesh_sense[index]
    line, mesh = line_of_action(scene, index, sense), scene.meshes[index]
    first, second = (scene.shaft(scene.gear(name).shaft).origin for name in (mesh.driver, mesh.driven))
    apart: FloatArray = np.subtract(second, first) * np.array([1.0, 1.0, 0.0])
    tilt = slope * np.cross(UNIT_Z, apart)
    return -float(tilt @ misalignment_per_tilt(scene, index, line, sense))
