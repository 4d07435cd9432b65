"""Gyroscopic moments along a shaft that bends: the motions that the spin couples, and their inertia."""

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
    """Return P (1 + b, 1 + b): integral of the moment of inertia about the axis times tilts of two motions.

    The motions are the shaft's tilt as a rigid body, then its b bending coordinates in one plane. Spinning at
    w it feels -w P J a' on their pairs a across the axis, J = z x.
    """
    if rotor.elastic is None or not rotor.elastic.bends:
        return np.array([[rotor.inertia.polar]])
    slope = rotor.elastic.bending.shape[1::2]
    tilts = np.concatenate([np.ones((slope.shape[0], 1)), slope], axis=1)
    return np.asarray(tilts.T @ rotor.elastic.polar @ tilts)


def pair_rows(rotors: Bodies, index: int) -> FloatArray:
    """Return tilts about x and y of each motion of `spun_inertia`, (1 + b, 2, N)."""
    count = spun_inertia(rotors[index]).shape[0]
    rows = np.zeros((count, 2, column_count(rotors)))
    rows[0, 0, 6 * index + TILT_X], rows[0, 1, 6 * index + TILT_Y] = 1.0, 1.0
    first = elastic_columns(rotors, index).start
    for j in range(1, count):  # du_x/dz tilts about y, du_y/dz against x
        rows[j, 1, first + j - 1], rows[j, 0, first + count + j - 2] = 1.0, -1.0
    return rows


def spun_pairs(rotors: Bodies, index: int, speed: float) -> list[tuple[FloatArray, float]]:
    """Return rows (2, N) and polar inertias whose sum is P, without those that shift no frequency.

    `speed` is the largest of the run, rad/s; infinite where it is not known.
    """
    rotor = rotors[index]
    inertia, rows = spun_inertia(rotor), pair_rows(rotors, index)
    if rotor.elastic is None or inertia.shape[0] == 1:
        return [(rows[0], float(inertia[0, 0]))]
    scale = np.sqrt(np.concatenate([[rotor.inertia.transverse], rotor.elastic.bending.mass]))
    share, vectors = np.linalg.eigh(inertia / np.outer(scale, scale))
    lowest = _lowest(rotor)
    pairs: list[tuple[FloatArray, float]] = []
    for value, vector in zip(share[::-1], vectors.T[::-1], strict=True):
        if pairs and value * speed <= 2.0 * MIN_SHIFT * lowest:
            break
        weight = scale * vector / scale[0]
        pairs.append((np.tensordot(weight, rows, axes=1), float(value * scale[0] ** 2)))
    return pairs


def _lowest(rotor: Rotor) -> float:
    """Return the lowest circular frequency a shaft may have across its axis, rad/s."""
    inertia, frequencies = rotor.inertia, []
    if rotor.elastic is not None and rotor.elastic.bends:
        frequencies.append(2.0 * math.pi * float(rotor.elastic.bending.frequency[0]))
    if rotor.radial_stiffness > 0.0:
        frequencies.append(math.sqrt(rotor.radial_stiffness / inertia.mass))
    if rotor.tilt_stiffness > 0.0:
        frequencies.append(math.sqrt(rotor.tilt_stiffness / inertia.transverse))
    return min(frequencies, default=0.0)
