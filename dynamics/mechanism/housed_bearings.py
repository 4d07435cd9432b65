"""Linear bearings in housings that move: where they act, and their force elements.

Local coordinates are lengths, m. Each of the p directions of a bearing, (p, 5), is a unit vector among x, y,
z, tilt_x, tilt_y; for a tilt it has the length of a lever, m.
"""

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
    """Return the bearings with stiffness or damping in housings that move."""
    supports = supports_by_name(rotors)
    if not rotors.housings:
        return ()
    names, lever = gather_supports(rotors, frozenset()).name, tilt_lever(scene)
    unit, bearings = np.diag([1.0, 1.0, 1.0, lever, lever]), []
    housed = [name for housing in rotors.housings for name in housing.bearings]
    for name in housed:
        part = supports[name][1]
        acting = np.any((part.seat_stiffness != 0.0) | (part.seat_damping != 0.0), axis=0)
        directions = unit[acting]
        if len(directions):
            row_stiffness = np.diag(_per_meter(directions, part.seat_stiffness)).copy()
            bearings.append(BearingElement(name, names.index(name), directions, directions, row_stiffness))
    return tuple(bearings)


def housed_bearing_elements(
    rotors: Bodies, bearings: Sequence[BearingElement]
) -> tuple[tuple[Element, ...], LinearBearingLaws]:
    """Return the elements of `bearings`, and their laws."""
    supports, elements, laws = supports_by_name(rotors), [], []
    for entry, bearing in enumerate(bearings):
        index, part = supports[bearing.name]
        directions, stiffness = bearing.directions, bearing.row_stiffness
        gradient, offset = directions @ seat_motion(rotors, index, part), np.zeros(len(directions))
        elements.append(Element(Law.LINEAR_BEARING, entry, -1, gradient, offset, stiffness=stiffness))
        damping = _per_meter(directions, part.seat_damping)
        laws.append((_per_meter(directions, part.seat_stiffness), damping))
    return tuple(elements), LinearBearingLaws.packed(laws)


def _per_meter(directions: FloatArray, matrix: FloatArray) -> FloatArray:
    """Return a bearing's matrix (5, 5) over its local coordinates, (p, p)."""
    # a tilt is the local coordinate over the lever: the row lever e over lever^2
    tilt_per_length = directions / np.sum(directions, axis=1, keepdims=True) ** 2
    return np.asarray(tilt_per_length @ matrix @ tilt_per_length.T)
