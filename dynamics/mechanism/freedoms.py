"""The freedoms of a system, and the six freedoms of every rotor as they follow from them.

A rotor has six: x, y, z, tilt_x, tilt_y, rotation. A rotation is a freedom of the system unless a rigid drive
imposes it, another one if an effect adds it; elastic coordinates of shafts and amplitudes of housings follow.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.carried_planets import FREEDOMS, ROTATION, carried_motion
from dynamics.mechanism.columns import elastic_columns, housing_columns
from dynamics.mechanism.kinematics import Kinematics
from dynamics.types import BoolArray, FloatArray, IntArray

COUPLED = ("x", "tilt_y", "bending_x", "y", "tilt_x", "bending_y", "z", "stretch", "rotation", "twist")
"""Order of a flexible shaft's freedoms: what bearings couple stays together, in the smallest blocks."""


class _Freedom(NamedTuple):
    """A freedom of a rotor or a housing."""

    name: str
    column: int
    turns: bool


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
        """Return a matrix over the freedoms of all bodies, its last axis, as one over the free ones."""
        return np.ascontiguousarray(np.asarray(matrix, dtype=float) @ self.motion)

    def find(self, rotor: int, kind: int) -> int:
        """Return the index of one of a rotor's six freedoms among the free ones, or -1."""
        index = np.flatnonzero(self.column == 6 * rotor + kind)
        return int(index[0]) if index.size else -1


def find_freedoms(rotors: Bodies, kinematics: Kinematics, added: Sequence[Collection[str]]) -> Freedoms:
    """Gather the freedoms `added` to each rotor, and the rotation of every shaft without a rigid drive."""
    freedoms: list[_Freedom] = []
    for index, rotor in enumerate(rotors):
        free = {*added[index], *rotor.bending_freedoms}
        if index not in kinematics.imposed:
            free.add("rotation")
        kinds = [
            _Freedom(kind, 6 * index + k, k == ROTATION) for k, kind in enumerate(FREEDOMS) if kind in free
        ]
        if rotor.elastic is not None:
            first, twists = elastic_columns(rotors, index).start, rotor.elastic.twists
            elastic = enumerate(rotor.elastic.kinds)
            kinds += [_Freedom(kind, first + k, bool(twists[k])) for k, kind in elastic]
            # names of elastic kinds end in a number
            kinds.sort(key=lambda part: COUPLED.index(part.name.rstrip("_0123456789")))
        freedoms += [part._replace(name=f"{rotor.shaft.name}.{part.name}") for part in kinds]
    for index, housing in enumerate(rotors.housings):
        first = housing_columns(rotors, index).start
        modes = enumerate(housing.kinds)
        freedoms += [_Freedom(f"{housing.name}.{kind}", first + k, turns=False) for k, kind in modes]
    column = np.array([part.column for part in freedoms], dtype=np.int64)
    return Freedoms(
        name=tuple(part.name for part in freedoms),
        column=column,
        motion=np.ascontiguousarray(carried_motion(rotors, column)[:, column]),
        turns=np.array([part.turns for part in freedoms], dtype=np.bool_),
    )
