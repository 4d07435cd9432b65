"""The freedoms of a system, and the six freedoms of every rotor as they follow from them.

A rotor has six: x, y, z, tilt_x, tilt_y, rotation. A rotation is a freedom of the system unless a rigid drive
imposes it, another one if an effect adds it; elastic coordinates of shafts and amplitudes of housings follow.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.carried_planets import FREEDOMS, ROTATION, carried_motion
from dynamics.mechanism.columns import elastic_columns, housing_columns
from dynamics.mechanism.kinematics import Kinematics
from dynamics.types import BoolArray, FloatArray, IntArray

COUPLED = ("x", "tilt_y", "bending_x", "y", "tilt_x", "bending_y", "z", "stretch", "rotation", "twist")
"""Order of a flexible shaft's freedoms: what bearings couple stays together, in the smallest blocks."""


@dataclass(frozen=True)
class Freedoms:
    """The free directions of motion."""

    name: tuple[str, ...]
    """"shaft.kind" with kind one of x, y, z (m), tilt_x, tilt_y, rotation (rad); "housing.mode_1" ... (m
    kg^1/2).
    """
    column: IntArray
    """Column of each freedom among the N freedoms of all bodies: 6 rotor + kind, elastic coordinates after
    all of these, then the amplitudes of housings. Shape (n,).
    """
    motion: FloatArray
    """All freedoms of all rotors per freedom: one at its index; planets go with their carrier where nothing
    lets them move on their own. Shape (N, n).
    """
    turns: BoolArray
    """Whether each is a rotation or a twist about the axis. Shape (n,)."""

    def keep(self, matrix: FloatArray) -> FloatArray:
        """Return a matrix whose last axis holds all freedoms of all rotors as one of the free ones."""
        return np.ascontiguousarray(np.asarray(matrix, dtype=float) @ self.motion)

    def find(self, rotor: int, kind: int) -> int:
        """Return the index of one of a rotor's six freedoms among the free ones, or -1."""
        index = np.flatnonzero(self.column == 6 * rotor + kind)
        return int(index[0]) if index.size else -1


def find_freedoms(rotors: Bodies, kinematics: Kinematics, added: Sequence[Collection[str]]) -> Freedoms:
    """Gather the freedoms `added` to each rotor, and the rotation of every shaft without a rigid drive."""
    freedoms: list[tuple[str, int, bool]] = []
    for index, rotor in enumerate(rotors):
        free = {*added[index], *rotor.rigid_kinds}
        if index not in kinematics.imposed:
            free.add("rotation")
        candidates = [(kind, 6 * index + k, k == ROTATION) for k, kind in enumerate(FREEDOMS) if kind in free]
        if rotor.elastic is not None:
            first, twists = elastic_columns(rotors, index).start, rotor.elastic.twists
            candidates += [(kind, first + k, bool(twists[k])) for k, kind in enumerate(rotor.elastic.kinds)]
            candidates.sort(key=lambda part: COUPLED.index(part[0].rstrip("_0123456789")))
        freedoms += [(f"{rotor.shaft.name}.{kind}", column, turns) for kind, column, turns in candidates]
    for index, housing in enumerate(rotors.housings):
        first = housing_columns(rotors, index).start
        freedoms += [(f"{housing.name}.{kind}", first + k, False) for k, kind in enumerate(housing.kinds)]
    column = np.array([part[1] for part in freedoms], dtype=np.int64)
    motion = carried_motion(rotors, column)[:, column]
    return Freedoms(
        tuple(part[0] for part in freedoms),
        column,
        np.ascontiguousarray(motion),
        np.array([part[2] for part in freedoms], dtype=np.bool_),
    )
