"""The motion of a bearing's inner ring and its answer: what compiled bearings read and write."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.types import FloatArray

DIRECTIONS = 5
"""x, y, z, tilt_x, tilt_y."""


class BearingSeat(NamedTuple):
    """State of one bearing of Z elements in L laminae each (balls: 1).

    Attributes
    ----------
    displacement : (5,) array
        Of the inner ring against the outer about the bearing's center: x, y, z (m), tilt_x, tilt_y (rad).
    force : (5,) array
        Force (N) and moment (N m) of the inner ring on the outer: the gradient of the energy.
    tangent : (5, 5) array
        Derivative of `force`; symmetric.
    load : (Z, L) array
        Normal load of every element, of every lamina of a roller, N, >= 0.
    """

    displacement: FloatArray
    force: FloatArray
    tangent: FloatArray
    load: FloatArray


def make_seat(elements: int, laminae: int) -> BearingSeat:
    """Allocate for a bearing of so many elements and laminae."""
    five = np.zeros(DIRECTIONS), np.zeros(DIRECTIONS), np.zeros((DIRECTIONS, DIRECTIONS))
    return BearingSeat(*five, np.zeros((elements, laminae)))
