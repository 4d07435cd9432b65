"""Tilts of shafts split by their causes: a linear functional of the displacements for each cause."""

from __future__ import annotations

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.deflection.bearing_strain import BearingStrain
from dynamics.joints import PlanetBearing
from dynamics.mechanism.bearing_elements import supports_by_name
from dynamics.mechanism.columns import section_rows
from dynamics.types import FloatArray

CAUSES = ("shaft", "bearing", "clearance", "housing", "coupling", "set")
"""Elastic shafts, elastic bearings, their clearance, the motion of their seats, shafts that couplings alone
hold, and what the scene itself sets."""
SHAFT, BEARING, CLEARANCE, HOUSING, COUPLING, SET = range(len(CAUSES))
TILT = slice(3, 5)


def gear_tilt(system: System, gear: str, motion: FloatArray, strain: BearingStrain) -> FloatArray:
    """Return tilt_x and tilt_y (rad) of a gear's section by cause, (causes, 2); their sum is the whole.

    The shaft's part is the tilt against the straight line through its bearing seats.
    """
    part = system.scene.gear(gear)
    index = system.scene.shaft_index(part.shaft)
    z = system.scene.shafts[index].origin[2] + part.position
    tilts = axis_tilt(system, index, motion, strain)
    tilts[SHAFT] += section_rows(system.rotors, index, z)[TILT] @ motion - tilts.sum(axis=0)
    return tilts


def axis_tilt(system: System, index: int, motion: FloatArray, strain: BearingStrain) -> FloatArray:
    """Return the tilt of the line through the bearing seats of the rotor `index` by cause, (causes, 2).

    The displaced centers of two bearings make the line, of more of them the line of least squares, of a
    single one the tilt of the shaft in it. A rotor without bearings has the tilt of its rigid motion. A
    planet's line goes with its carrier's.
    """
    rotor, tilts = system.rotors[index], np.zeros((len(CAUSES), 2))
    carried = [part for part in rotor.supports if isinstance(part, PlanetBearing)]
    if carried and rotor.carrier is not None:
        tilts += axis_tilt(system, rotor.carrier, motion, strain)
    names = _radial(system, index)
    if not names:
        tilts[COUPLING] += motion[6 * index + 3 : 6 * index + 5]
        return tilts
    places = supports_by_name(system.rotors)
    z = np.array([places[name][1].position for name in names])
    at = [system.supports.name.index(name) for name in names]
    for cause, moved in ((BEARING, strain.elastic), (CLEARANCE, strain.clearance), (HOUSING, strain.seat)):
        tilts[cause] += line_tilt(z, moved[at])
    return tilts


def line_tilt(z: FloatArray, moved: FloatArray) -> FloatArray:
    """Return tilt_x and tilt_y (rad) of the line through points at z (S,), m, moved by `moved` (S, 5).

    u_x = tilt_y z and u_y = -tilt_x z.
    """
    away = z - z.mean()
    if float(np.max(np.abs(away))) == 0.0:
        return np.asarray(moved[:, TILT].mean(axis=0))
    slope = away @ moved[:, :2] / (away @ away)
    return np.array([-slope[1], slope[0]])


def _radial(system: System, index: int) -> list[str]:
    """Return the bearings of a rotor that hold it across its axis."""
    lawful = {system.supports.name[at.support] for at in system.bearings if at.way[:, :2].any()}
    return [
        part.name
        for part in system.rotors[index].supports
        if part.name in lawful or part.seat_stiffness[0, 0] + part.seat_stiffness[1, 1] > 0.0
    ]
