"""The forces that shafts exert on the ground or on pins, as one sparse linear map of state and forces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dynamics.bearings.seat import SEAT
from dynamics.forces.elements import Elements
from dynamics.mechanism.bearing_elements import BearingElement
from dynamics.mechanism.connections import Connections
from dynamics.types import FloatArray, IntArray

_NO_INDEX = np.zeros(0, dtype=np.int64)


class BearingForce(NamedTuple):
    """The sparse linear map from local forces (R), displacements (n) and rates (n) to forces at supports.

    A signal is one component of the force, or of the moment, at one support; S signals in all, T samples.
    """

    first: IntArray
    """First entry of every signal, then the number E of all entries. Shape (S + 1,).

    Each support has 3 signals, or 6 with moments, in its frame.
    """
    column: IntArray
    """Column that an entry multiplies: index of a local force, R + freedom, or R + n + freedom. Shape (E,).
    """
    weight: FloatArray
    """Weight of each entry, N or N m per unit of its column. Shape (E,)."""
    constant: FloatArray
    """Constant part of each signal, N or N m. Shape (S,)."""
    freedoms: int
    """The number n of freedoms."""

    def of(self, local: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Return the signals (S, T) of the local forces (R, T), `q` and `v` (T, n).

        Freedoms that move no support may be missing at the end of `q` and `v`.
        """
        missing = [None] * (self.freedoms - q.shape[1])  # no entry reads these
        state = [*local, *q.T, *missing, *v.T]
        signals, part = np.empty((self.constant.size, q.shape[0])), np.empty(q.shape[0])
        signals[:] = self.constant[:, None]
        for signal, (start, end) in enumerate(zip(self.first[:-1], self.first[1:], strict=True)):
            for entry in range(start, end):
                signals[signal] += np.multiply(self.weight[entry], state[self.column[entry]], out=part)
        return signals


NO_SIGNALS = BearingForce(np.zeros(1, dtype=np.int64), _NO_INDEX, np.zeros(0), np.zeros(0), 0)
"""The map of a system without supports."""


def bearing_force_map(
    stiffness: FloatArray,
    damping: FloatArray,
    connections: Connections,
    bearings: Sequence[BearingElement],
    elements: Elements,
) -> BearingForce:
    """Return the map of b supports by their linear `stiffness` and `damping`, (b, 3 or 6, n), and `elements`.

    The constant part holds the preload of seats, and what springs of supports press against the errors of
    their pins. The last elements are those of `bearings` that are not linear or sit in a housing that moves:
    their forces act at the support.
    """
    supports, seats = connections.supports, connections.seats
    count, rows, n = stiffness.shape
    total = elements.offset.size
    weight = np.zeros((count, rows, total + 2 * n))
    weight[:, :, total : total + n] = stiffness
    weight[:, :, total + n :] = damping
    constant = np.zeros((count, rows))
    constant[:, :3] -= supports.stiffness * supports.error
    if seats.name:
        constant[seats.support, :SEAT] -= seats.preload.reshape(-1, SEAT)
    first = elements.first[len(elements.law) - len(bearings) :]
    for start, bearing in zip(first, bearings, strict=False):  # the last of `first` is the number of rows
        components = np.flatnonzero(np.any(bearing.directions != 0.0, axis=0))
        for local, direction in enumerate(bearing.directions, start=start):
            weight[bearing.support, components, local] += direction[components]
    flat = weight.reshape(count * rows, total + 2 * n)
    signal, column = np.nonzero(flat)
    starts = np.searchsorted(signal, np.arange(count * rows + 1))
    return BearingForce(
        first=starts.astype(np.int64),
        column=column.astype(np.int64),
        weight=flat[signal, column],
        constant=constant.ravel(),
        freedoms=n,
    )
