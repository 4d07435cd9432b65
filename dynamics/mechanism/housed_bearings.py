"""Linear bearings in housings that move: where they act, and their force elements."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.bearings.linear_bearing import LinearBearingLaws
from dynamics.forces.elements import Element
from dynamics.forces.laws import Law
from dynamics.mechanism.bearing_elements import BearingElement, supports_by_name, tilt_lever
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.supports import gather_supports, seat_motion
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


def housed_bearings(scene: Scene, rotors: Bodies) -> tuple[BearingElement, ...]:
    """Return the bearings with stiffness or damping in housings that move, tilts by a lever."""
    supports = supports_by_name(rotors)
    if not rotors.housings:
        return ()
    names, lever = gather_supports(rotors, frozenset()).name, tilt_lever(scene)
    unit, bearings = np.diag([1.0, 1.0, 1.0, lever, lever]), []
    for name in (name for housing in rotors.housings for name in housing.bearings):
        part = supports[name][1]
        acting = np.any((part.seat_stiffness != 0.0) | (part.seat_damping != 0.0), axis=0)
        way = unit[acting]
        if len(way):
            row_stiffness = np.diag(_per_meter(way, part.seat_stiffness)).copy()
            bearings.append(BearingElement(name, names.index(name), way, way, row_stiffness))
    return tuple(bearings)


def housed_bearing_elements(
    rotors: Bodies, bearings: Sequence[BearingElement]
) -> tuple[tuple[Element, ...], LinearBearingLaws]:
    """Return the elements of `bearings`, and their laws."""
    supports, elements, laws = supports_by_name(rotors), [], []
    for entry, at in enumerate(bearings):
        index, part = supports[at.name]
        gradient, none = at.directions @ seat_motion(rotors, index, part), np.zeros(len(at.directions))
        elements.append(Element(Law.LINEAR_BEARING, entry, -1, gradient, none, stiffness=at.row_stiffness))
        stiffness = _per_meter(at.directions, part.seat_stiffness)
        laws.append((stiffness, _per_meter(at.directions, part.seat_damping)))
    return tuple(elements), LinearBearingLaws.packed(laws)


def _per_meter(way: FloatArray, matrix: FloatArray) -> FloatArray:
    """Return a bearing's matrix (5, 5) in the rows `way` (p, 5), (p, p)."""
    back = way / np.sum(way, axis=1, keepdims=True) ** 2
    return np.asarray(back @ matrix @ back.T)
