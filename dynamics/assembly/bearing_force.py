"""Forces of the shafts on the ground or on pins at every support, linear in state and local forces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dynamics.bearings.seat import SEAT
from dynamics.forces.elements import Elements
from dynamics.mechanism.bearing_elements import BearingElement
from dynamics.mechanism.seats import Seats
from dynamics.mechanism.supports import Supports
from dynamics.types import FloatArray, IntArray


class BearingForce(NamedTuple):
    """The sparse linear map from local forces (R), displacements (n) and rates (n) to forces at supports.

    Attributes
    ----------
    first : (S + 1,) int array
        Where the entries of each signal begin: 3 or 6 (with moments) signals per support, in its own frame.
    column : (E,) int array
        Local force, R + freedom, or R + n + freedom.
    weight : (E,) array
        N or N m per unit.
    constant : (S,) array
        N or N m.
    freedoms : int
        n.
    """

    first: IntArray
    column: IntArray
    weight: FloatArray
    constant: FloatArray
    freedoms: int

    def of(self, local: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Return the signals (S, T) of the local forces (R, T), `q` and `v` (T, n).

        Freedoms that move no support may be missing at the end of `q` and `v`.
        """
        missing = [None] * (self.freedoms - q.shape[1])
        state = [*local, *q.T, *missing, *v.T]
        signals, part = np.repeat(self.constant[:, None], q.shape[0], axis=1), np.empty(q.shape[0])
        for signal, (start, end) in enumerate(zip(self.first[:-1], self.first[1:], strict=True)):
            for entry in range(start, end):
                signals[signal] += np.multiply(self.weight[entry], state[self.column[entry]], out=part)
        return signals


def bearing_force_map(
    stiffness: FloatArray,
    damping: FloatArray,
    supports: Supports,
    seats: Seats,
    bearings: Sequence[BearingElement],
    elements: Elements,
) -> BearingForce:
    """Gather the map from `stiffness` and `damping` (b, 3 or 6, n) and the laws of the bearings.

    Springs of supports press against their errors, seats have preloads, and bearings that are not linear or
    sit in a housing that moves give their own forces: the last elements.
    """
    count, rows, n = stiffness.shape
    total = elements.offset.size
    weight = np.zeros((count, rows, total + 2 * n))
    weight[:, :, total : total + n], weight[:, :, total + n :] = stiffness, damping
    constant = np.zeros((count, rows))
    constant[:, :3] -= supports.stiffness * supports.error
    if seats.name:
        constant[seats.support, :SEAT] -= seats.preload.reshape(-1, SEAT)
    first = elements.first[len(elements.law) - len(bearings) :]
    for start, at in zip(first, bearings, strict=False):
        for local, way in enumerate(at.way, start=start):
            moved = np.flatnonzero(np.any(at.way != 0.0, axis=0))
            weight[at.support, moved, local] += way[moved]
    flat = weight.reshape(count * rows, total + 2 * n)
    signal, column = np.nonzero(flat)
    starts = np.searchsorted(signal, np.arange(count * rows + 1))
    return BearingForce(
        starts.astype(np.int64), column.astype(np.int64), flat[signal, column], constant.ravel(), n
    )
