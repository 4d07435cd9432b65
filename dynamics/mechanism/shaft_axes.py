"""The axes of all shafts by points along them, with the motion of each point per freedom."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import section_rows
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray, IntArray
from model_studies import in_unit


@dataclass(frozen=True)
class ShaftAxes:
    """P points of all shafts in a row."""

    shaft: IntArray = field(metadata={"dimensions": ("point",)})
    """Index of the shaft in the scene. Shape (P,)."""
    position: FloatArray = field(metadata=in_unit("m", "point"))
    """Along it from its left end, m, increasing within a shaft. Shape (P,)."""
    motion: FloatArray
    """x, y, z (m), tilt_x, tilt_y, rotation (rad) per freedom of all bodies. Shape (P, 6, N)."""


def shaft_axes(scene: Scene, rotors: Bodies) -> ShaftAxes:
    """Return the axes: at the nodes of an elastic shaft, at the ends and parts of a rigid one."""
    shaft, position, motion = [], [], []
    for index, rotor in enumerate(rotors):
        on = [gear.position for gear in scene.gears if gear.shaft == rotor.shaft.name]
        on += [support.position for support in rotor.supports]
        points = sorted({0.0, rotor.shaft.length, *map(float, on)})
        if rotor.elastic is not None:
            points = [float(node) for node in rotor.elastic.position]
        shaft += [index] * len(points)
        position += points
        motion += [section_rows(rotors, index, rotor.shaft.origin[2] + along) for along in points]
    return ShaftAxes(np.array(shaft, dtype=np.int64), np.array(position), np.array(motion))
