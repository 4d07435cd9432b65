"""Quantities of a vibration: displacement and its rates."""

from __future__ import annotations

import math
from enum import StrEnum, auto

import numpy as np

from dynamics.types import FloatArray
from dynamics.vibration.seat_forces import ComplexArray


class MotionQuantity(StrEnum):
    """What of a motion is meant."""

    DISPLACEMENT = auto()
    VELOCITY = auto()
    ACCELERATION = auto()

    @property
    def rate(self) -> int:
        """Number of derivatives in time: 0, 1, 2."""
        return list(MotionQuantity).index(self)

    def of(self, displacement: ComplexArray, frequency: FloatArray) -> ComplexArray:
        """Return complex amplitudes of the quantity, by those of the displacement in m or rad.

        Parameters
        ----------
        displacement : array
        frequency : array
            Hz, of a shape that spreads over that of `displacement`.
        """
        return np.asarray((2j * math.pi * np.asarray(frequency)) ** self.rate * displacement)
