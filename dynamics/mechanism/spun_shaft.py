"""Gyroscopic moments along a shaft that bends: the motions that the spin couples, and their inertia.

The motions of a shaft are its tilt as a rigid body and its b bending coordinates in one plane. Each exists in
two planes, and turns sections about x and about y. N is the number of freedoms of all rotors.
"""

from __future__ import annotations

import math

import numpy as np

from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import column_count, elastic_columns
from dynamics.mechanism.rotor import Rotor
from dynamics.types import FloatArray

MIN_SHIFT = 1e-4
"""Relative shift of a natural frequency below which a part of the moments is left out of time integration."""
TILT_X, TILT_Y = 3, 4  # indices of the tilts among the freedoms of a rotor


def spun_inertia(rotor: Rotor) -> FloatArray:
    """Return the polar inertia P (1 + b, 1 + b) of the motions of a shaft.

    P_jk is the integral along the shaft of the moment of inertia about the axis times the tilts of the
    motions j and k. A shaft that spins at w feels the moments -w P (z x a') about x and y. Here a (1 + b, 2)
    are the amplitudes of the motions about x and y, a' their rates, and z the unit vector along the axis.
    """
    if rotor.elastic is None or not rotor.elastic.bends:
        return np.array([[rotor.inertia.polar]])
    slope = rotor.elastic.bending.shape[1::2]  # rows: displacement and slope of each node in turn
    tilts = np.concatenate([np.ones((slope.shape[0], 1)), slope], axis=1)
    return np.asarray(tilts.T @ rotor.elastic.polar @ tilts)  # `polar`: inertia over the nodes' tilts


def pair_rows(rotors: Bodies, index: int) -> FloatArray:
    """Return tilts about x and y of each motion of `spun_inertia`, (1 + b, 2, N)."""
    count = spun_inertia(rotors[index]).shape[0]
    rows = np.zeros((count, 2, column_count(rotors)))
    rows[0, 0, 6 * index + TILT_X] = 1.0
    rows[0, 1, 6 * index + TILT_Y] = 1.0
    bending = count - 1
    bending_x = elastic_columns(rotors, index).start  # the coordinates in x z come first, then those in y z
    bending_y = bending_x + bending
    for j in range(bending):
        rows[1 + j, 1, bending_x + j] = 1.0  # du_x/dz is a tilt about +y
        rows[1 + j, 0, bending_y + j] = -1.0  # du_y/dz is a tilt about -x
    return rows


def spun_pairs(rotors: Bodies, index: int, speed: float) -> list[tuple[FloatArray, float]]:
    """Return uncoupled pairs of motions: rows (2, N) of their tilts, and the polar inertia of each pair.

    Together they are P, without the pairs whose moments shift no frequency by more than `MIN_SHIFT`. `speed`
    is the largest of the run, rad/s; infinite where it is not known.
    """
    rotor = rotors[index]
    inertia, rows = spun_inertia(rotor), pair_rows(rotors, index)
    if rotor.elastic is None or inertia.shape[0] == 1:
        return [(rows[0], float(inertia[0, 0]))]
    scale = np.sqrt(np.concatenate([[rotor.inertia.transverse], rotor.elastic.bending.mass]))
    # In motions of unit modal mass the eigenvalues of P are polar inertia over transverse inertia.
    share, vectors = np.linalg.eigh(inertia / np.outer(scale, scale))
    lowest = _lowest(rotor)
    pairs: list[tuple[FloatArray, float]] = []
    for value, vector in zip(share[::-1], vectors.T[::-1], strict=True):
        # The moments shift a frequency f (rad/s) by `value * speed / 2`. The first pair always remains.
        if pairs and value * speed <= 2.0 * MIN_SHIFT * lowest:
            break
        weight = scale * vector / scale[0]  # back to the motions, in units of the tilt of the rigid body
        pairs.append((np.tensordot(weight, rows, axes=1), float(value * scale[0] ** 2)))
    return pairs


def _lowest(rotor: Rotor) -> float:
    """Return the lowest circular frequency that a shaft may have across its axis, rad/s; 0: not known."""
    inertia, frequencies = rotor.inertia, []
    if rotor.elastic is not None and rotor.elastic.bends:
        frequencies.append(2.0 * math.pi * float(rotor.elastic.bending.frequency[0]))
    if rotor.radial_stiffness > 0.0:
        frequencies.append(math.sqrt(rotor.radial_stiffness / inertia.mass))
    if rotor.tilt_stiffness > 0.0:
        frequencies.append(math.sqrt(rotor.tilt_stiffness / inertia.transverse))
    return min(frequencies, default=0.0)
