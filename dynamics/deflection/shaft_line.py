"""Deflection lines of shafts."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.mechanism.columns import section_rows
from dynamics.types import FloatArray, IntArray
from model_studies import Record, in_unit


@dataclass(frozen=True)
class ShaftLines(Record):
    """The axes of all shafts under a load case, mean over the mesh cycle, P points of all shafts in a row.

    Attributes
    ----------
    shaft : (P,) int array
        Index of the shaft in the scene.
    position : (P,) array
        Along it from its left end, m, increasing within a shaft.
    motion : (P, 6) array
        x, y, z (m), tilt_x, tilt_y, rotation (rad): du_x/dz = tilt_y and du_y/dz = -tilt_x but for shear.
    """

    shaft: IntArray = field(metadata={"dimensions": ("point",)})
    position: FloatArray = field(metadata=in_unit("m", "point"))
    motion: FloatArray = field(metadata=in_unit("m", "point", "freedom"))


def shaft_lines(system: System, motion: FloatArray) -> ShaftLines:
    """Return the lines at `motion` (N,): at the nodes of an elastic shaft, at what is on a rigid one."""
    shaft, position, moved = [], [], []
    for index, rotor in enumerate(system.rotors):
        for along in _points(system, index):
            z = rotor.shaft.origin[2] + along
            shaft.append(index)
            position.append(along)
            moved.append(section_rows(system.rotors, index, z) @ motion)
    return ShaftLines(np.array(shaft, dtype=np.int64), np.array(position), np.array(moved).reshape(-1, 6))


def _points(system: System, index: int) -> list[float]:
    """Return positions along the shaft `index`, m."""
    rotor, scene = system.rotors[index], system.scene
    if rotor.elastic is not None:
        return [float(position) for position in rotor.elastic.position]
    on = [gear.position for gear in scene.gears if gear.shaft == rotor.shaft.name]
    on += [support.position for support in rotor.supports]
    return sorted({0.0, rotor.shaft.length, *map(float, on)})
