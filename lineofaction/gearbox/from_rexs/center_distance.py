"""Center distance and axial offset of a stage."""

from __future__ import annotations

import numpy as np

from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.meshing import Meshing
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.placement import frame_of
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import MM


def center_distance_of(unit: GearUnit, stage: Part, meshing: Meshing) -> float:
    """Return the center distance in m: the stage's own, else the distance of the gears' axes.

    Raises
    ------
    BadInput
        Neither is above zero.
    """
    value = stage.number("center_distance", "center_distance_mm")
    if value:
        return abs(value)
    apart = _apart(unit, meshing)
    distance = float(np.linalg.norm(apart - (apart @ meshing.z) * meshing.z))
    if not distance > 0.0:
        raise BadInput.of(f"{stage.place}, center_distance", value, "given, or gears on axes apart")
    stage.say("center_distance", "derived", f"{distance / MM:.7g} mm, the distance of the gears' axes")
    return distance


def axial_offset_of(unit: GearUnit, meshing: Meshing) -> float:
    """Return the distance in m of the wheel's mid-face from the pinion's, towards +z."""
    return float(_apart(unit, meshing) @ meshing.z)


def _apart(unit: GearUnit, meshing: Meshing) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return the way from the pinion's middle to the wheel's, m."""
    return frame_of(unit, meshing.wheel).origin - frame_of(unit, meshing.pinion).origin
