"""The freedoms of a system: which there are, and how the six of every rotor follow from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.system.effects import FREEDOMS
from dynamics.system.effects.ledger import EffectLedger
from dynamics.system.kinematics import Kinematics
from dynamics.system.planets import carried_motion
from dynamics.system.rotor import Rotor
from dynamics.types import FloatArray, IntArray

ROTATION = FREEDOMS.index("rotation")


@dataclass(frozen=True)
class Freedoms:
    """The free directions of motion.

    Attributes
    ----------
    name : tuple of str
        "shaft.kind" with kind one of x, y, z (m), tilt_x, tilt_y, rotation (rad).
    place : (n,) int array
        Of each among the six freedoms of all rotors: 6 rotor + kind.
    motion : (6 r, n) array
        The six freedoms of all rotors per freedom: one at its place; planets go with their carrier where
        nothing lets them move on their own.
    """

    name: tuple[str, ...]
    place: IntArray
    motion: FloatArray

    def keep(self, matrix: FloatArray) -> FloatArray:
        """Return a matrix whose last axis holds all 6 freedoms of all rotors as one of the freedoms."""
        return np.ascontiguousarray(np.asarray(matrix, dtype=float) @ self.motion)

    def find(self, rotor: int, kind: int) -> int:
        """Return the place of one of a rotor's six freedoms among the free ones, or -1."""
        found = np.flatnonzero(self.place == 6 * rotor + kind)
        return int(found[0]) if found.size else -1


def find_freedoms(rotors: Sequence[Rotor], kinematics: Kinematics, ledger: EffectLedger) -> Freedoms:
    """Gather the freedoms that effects add, and the rotation of every shaft without a rigid drive."""
    names, places = [], []
    for index, rotor in enumerate(rotors):
        free = set(ledger.freedoms(rotor.shaft.name))
        if index not in kinematics.imposed:
            free.add("rotation")
        for kind, freedom in enumerate(FREEDOMS):
            if freedom in free:
                names.append(f"{rotor.shaft.name}.{freedom}")
                places.append(6 * index + kind)
    place = np.array(places, dtype=np.int64)
    motion = carried_motion(rotors, place)[:, place]
    return Freedoms(tuple(names), place, np.ascontiguousarray(motion))


def mass_diagonal(rotors: Sequence[Rotor]) -> FloatArray:
    """Return the (6 r,) mass matrix: diagonal, since the freedoms are those of the centres of mass."""
    inertia = [rotor.inertia for rotor in rotors]
    diagonal = [[i.mass, i.mass, i.mass, i.transverse, i.transverse, i.polar] for i in inertia]
    return np.array(diagonal, dtype=float).ravel()


def shared_blocks(matrices: Sequence[FloatArray]) -> IntArray:
    """Return (n, 2): first and end column of each row's block, the finest that all `matrices` share."""
    size = matrices[0].shape[0]
    coupled = np.any([matrix != 0.0 for matrix in matrices], axis=0)
    starts, reach = [], 0
    for i in range(size):
        if i >= reach:
            starts.append(i)
        linked = np.flatnonzero(coupled[i])
        reach = max([reach, i + 1, *(linked + 1).tolist()])
    ends = [*starts[1:], size]
    spans = [[start, end] for start, end in zip(starts, ends, strict=True) for _ in range(start, end)]
    return np.array(spans, dtype=np.int64).reshape(-1, 2)
