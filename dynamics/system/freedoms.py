"""The freedoms of a system: which there are, and the arrays that follow from each rotor's six."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.joints import Bushing
from dynamics.system.effects import FREEDOMS
from dynamics.system.effects.ledger import EffectLedger
from dynamics.system.kinematics import Kinematics
from dynamics.system.rotor import Rotor
from dynamics.types import FloatArray, IntArray


@dataclass(frozen=True)
class Freedoms:
    """The free directions of motion.

    Attributes
    ----------
    name : tuple of str
        "shaft.kind" with kind one of x, y, z (m), tilt_x, tilt_y, rotation (rad).
    place : (n,) int array
        Of each among the six freedoms of all rotors: 6 rotor + kind.
    """

    name: tuple[str, ...]
    place: IntArray

    def keep(self, matrix: FloatArray) -> FloatArray:
        """Return the free columns of a matrix whose last axis holds all 6 freedoms of all rotors."""
        return np.ascontiguousarray(np.asarray(matrix, dtype=float)[..., self.place])


def find_freedoms(rotors: Sequence[Rotor], kinematics: Kinematics, ledger: EffectLedger) -> Freedoms:
    """Gather the freedoms that effects add, and the rotation of every shaft but the drive's."""
    names, places = [], []
    for index, rotor in enumerate(rotors):
        free = set(ledger.freedoms(rotor.shaft.name))
        if index != kinematics.drive:
            free.add("rotation")
        for kind, freedom in enumerate(FREEDOMS):
            if freedom in free:
                names.append(f"{rotor.shaft.name}.{freedom}")
                places.append(6 * index + kind)
    return Freedoms(tuple(names), np.array(places, dtype=np.int64))


def mass_diagonal(rotors: Sequence[Rotor]) -> FloatArray:
    """Return the (6 r,) mass matrix: diagonal, since the freedoms are those of the centres of mass."""
    inertia = [rotor.inertia for rotor in rotors]
    diagonal = [[i.mass, i.mass, i.mass, i.transverse, i.transverse, i.polar] for i in inertia]
    return np.array(diagonal, dtype=float).ravel()


def bushing_kinematics(rotors: Sequence[Rotor]) -> FloatArray:
    """Return (bushings, 3, 6 r): displacement of each bushing's axis point per freedom.

    A small rotation r moves the point z along the axis by r x (0, 0, z) = (tilt_y z, -tilt_x z, 0).
    """
    rows = []
    for index, rotor in enumerate(rotors):
        for bushing in rotor.bushings:
            row = np.zeros((3, 6 * len(rotors)))
            row[:, 6 * index : 6 * index + 3] = np.eye(3)
            row[0, 6 * index + 4], row[1, 6 * index + 3] = rotor.lever(bushing), -rotor.lever(bushing)
            rows.append(row)
    return np.array(rows).reshape(-1, 3, 6 * len(rotors))


def bushing_coefficients(bushings: Sequence[Bushing]) -> tuple[FloatArray, FloatArray]:
    """Return stiffness (b, 3) and damping (b, 3) along x, y, z."""
    stiffness = [[b.radial_stiffness, b.radial_stiffness, b.axial_stiffness] for b in bushings]
    damping = [[b.radial_damping or 0.0, b.radial_damping or 0.0, b.axial_damping or 0.0] for b in bushings]
    return np.array(stiffness).reshape(-1, 3), np.array(damping).reshape(-1, 3)


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
