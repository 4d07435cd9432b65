"""The matrices of a rotating system as polynomials of speed, in meters.

Rotating frames add terms in the speed and its square: gyroscopic, Coriolis and centripetal ones, and damping
that the ground exerts on them. The leading law is the first drive or free rotation that turns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.linearize.linear_system import LinearSystem
from dynamics.linearize.operating_speeds import law_speeds
from dynamics.linearize.whirl_modes import terms_at
from dynamics.types import ComplexArray, FloatArray


@dataclass(frozen=True)
class SpeedMatrices:
    """P(s, W) = s^2 M + s (C + W G) + K + W S + W^2 T of n freedoms in meters, W the leading law's speed.

    Gyroscopic terms G grow with the speed, centripetal ones T with its square, dampers across frames (S) with
    it.
    """

    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    gyroscopic: FloatArray
    swept: FloatArray
    centripetal: FloatArray

    def at(self, eigenvalue: complex, speed: float) -> ComplexArray:
        """Return P."""
        rate = self.damping + speed * self.gyroscopic
        rest = self.stiffness + speed * self.swept + speed**2 * self.centripetal
        return np.asarray(eigenvalue**2 * self.mass + eigenvalue * rate + rest)

    def by_eigenvalue(self, eigenvalue: complex, speed: float) -> ComplexArray:
        """Return dP/ds."""
        return np.asarray(2.0 * eigenvalue * self.mass + self.damping + speed * self.gyroscopic)

    def by_speed(self, eigenvalue: complex, speed: float) -> ComplexArray:
        """Return dP/dW."""
        return np.asarray(eigenvalue * self.gyroscopic + self.swept + 2.0 * speed * self.centripetal)


def speed_matrices(system: System, linear: LinearSystem, speed: float) -> SpeedMatrices:
    """Return the matrices, their speed terms from those at `speed` (rad/s, not 0) and at twice that."""
    per_meter = 1.0 / linear.scale
    gyroscopic, once = terms_at(system, law_speeds(system, speed))
    _, twice = terms_at(system, law_speeds(system, 2.0 * speed))
    swept, centripetal = (4.0 * once - twice) / (2.0 * speed), (twice - 2.0 * once) / (2.0 * speed**2)
    parts = (linear.mass, linear.damping, linear.stiffness, gyroscopic / speed, swept, centripetal)
    return SpeedMatrices(*(per_meter[:, None] * part * per_meter for part in parts))
