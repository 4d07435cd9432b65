"""A scene at its steady temperatures: warm parts in place of the parts as drawn.

All parts expand freely and alike in all directions. Lengths, radii and base pitches stay as drawn: their
relative change of some 1e-4 is neglected. What depends on small differences of sizes changes: play and axial
force of bearings, center distance, backlash and misalignment of meshes.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import accumulate

import numpy as np

from dynamics.bearings import Bushing, RollingBearing
from dynamics.bearings.rolling_bearing import BallBearing
from dynamics.bearings.row_law import row_law
from dynamics.bearings.warm_rings import Cylinder, warm_rings
from dynamics.errors import InputError
from dynamics.scene.scene import Scene
from dynamics.shafts import Shaft
from dynamics.temperatures import Temperatures, WarmBearing


def warmed_bearings(scene: Scene) -> Scene:
    """Return `scene` with its bearings at temperature.

    A scene without temperatures, or whose bearings are at temperature already, is returned itself. Raises
    `InputError`: temperatures change a row or a curve of a bearing beyond its bounds.
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
    growth = {part.name: _growth(scene, warm, part) for part in scene.bushings}
    return replace(
        scene,
        rolling_bearings=tuple(rows[part.name].warm for part in scene.rolling_bearings),
        bushings=tuple(_preloaded_bushing(part, growth[part.name]) for part in scene.bushings),
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
    shift = row_law(bearing).shift + _growth(scene, warm, bearing)
    try:
        row = replace(bearing.row, clearance=bearing.row.clearance + rings.play)
    except InputError as error:
        bound, remedy = error.bound, "The temperatures change it by more than the row can have."
        name = "ball" if isinstance(bearing.row, BallBearing) else "roller"
        raise InputError(f"{name}.{error.field}", error.value, bound, remedy) from None
    fits = zip(("inner ring", "outer ring"), rings.interference or (0.0, 0.0), strict=True)
    return WarmBearing(
        bearing,
        replace(bearing, row=row, axial_preload=0.0, axial_shift=shift),
        {name: -interference for name, interference in fits if interference < 0.0},
    )


def _seat(warm: Temperatures, shaft: Shaft, position: float) -> Cylinder:
    """Return the shaft in a bearing: solid steel where it has no sections."""
    strain = warm.strain(shaft.thermal_expansion, shaft.temperature)
    if not shaft.sections:
        return Cylinder(0.0, 1.0, strain=strain)  # the fits give the diameter of the seat
    ends = accumulate(section.length for section in shaft.sections)
    sections = zip(shaft.sections, ends, strict=True)
    seat = next((section for section, end in sections if position <= end), shaft.sections[-1])
    return Cylinder(seat.bore_diameter, seat.outer_diameter, seat.youngs_modulus, seat.poissons_ratio, strain)


def _wall(warm: Temperatures, bearing: RollingBearing) -> Cylinder:
    outer = bearing.fits.housing_diameter if bearing.fits else 1.0
    material, strain = warm.housing_material, warm.housing_strain(bearing.seat_temperature)
    return Cylinder(0.0, outer, material.youngs_modulus, material.poissons_ratio, strain)


def _growth(scene: Scene, warm: Temperatures, bearing: Bushing | RollingBearing) -> float:
    """Return the expansion of the shaft along z relative to the housing at a bearing, m.

    Bearings that hold the shaft along z move by 0 on the average: a single one locates it, a pair shares the
    expansion between them.
    """
    bearings = on_ground(scene, bearing.shaft)
    axial_positions = [part.position for part in bearings if _holds_axially(scene, part)]
    if not _holds_axially(scene, bearing) or len(axial_positions) < 2:
        return 0.0
    shaft = scene.shaft(bearing.shaft)
    housing = float(np.mean([warm.housing_strain(part.seat_temperature) for part in bearings]))
    strain = warm.strain(shaft.thermal_expansion, shaft.temperature) - housing
    return strain * (bearing.position - float(np.mean(axial_positions)))


def on_ground(scene: Scene, shaft: str) -> list[Bushing | RollingBearing]:
    """Return the bearings between a shaft and the ground."""
    parts: tuple[Bushing | RollingBearing, ...] = (*scene.bushings, *scene.rolling_bearings)
    return [part for part in parts if part.shaft == shaft]


def _holds_axially(scene: Scene, bearing: Bushing | RollingBearing) -> bool:
    if isinstance(bearing, RollingBearing):
        rolls = not isinstance(bearing.row, BallBearing) and bearing.row.contact_angle == 0.0
        return bearing.locating != "none" and not rolls
    laws = [law for law in scene.scene_bearing_laws if law.bushing == bearing.name]
    return float(bearing.seat_stiffness[2, 2]) > 0.0 or any(law.holds_axially for law in laws)


def _preloaded_bushing(bushing: Bushing, growth: float) -> Bushing:
    """Return a bushing whose shaft has grown by `growth` (m) along z: its springs push back as preload."""
    if growth == 0.0:
        return bushing
    force = np.zeros(5) if bushing.preload is None else np.array(bushing.preload)
    force = force - bushing.seat_stiffness[:, 2] * growth
    return replace(bushing, preload=tuple(float(value) for value in force))
