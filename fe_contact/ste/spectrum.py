"""Orders of a transmission-error curve: mesh harmonics, and what lies between them over a longer period."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.types import FloatArray

HARMONICS = 20
# samples of one pitch, and of a whole period where that would be too many; 256 a pitch leave room for a mesh
# harmonic six times the highest one requested
_PER_PITCH, _PER_PERIOD, _FEWEST = 4096, 2**18, 256


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Amplitudes of ste(x) = mean + sum A_k cos(2 pi o_k x + phi_k), x in base pitches.

    Attributes
    ----------
    order : (K,) array
        o_k in cycles per base pitch: whole numbers are the mesh harmonics, others sidebands and the orders
        of single teeth. 1/period, 2/period .. 20.
    amplitude : (K,) array
        A_k in m.
    phase : (K,) array
        phi_k in rad.
    error : float
        Half-width of the error band of every amplitude, m.
    teeth : (int, int)
        Of the driving and the driven gear.
    """

    order: FloatArray
    amplitude: FloatArray
    phase: FloatArray
    error: float
    teeth: tuple[int, int]

    @property
    def pinion_order(self) -> FloatArray:
        """Cycles per revolution of the driving gear, (K,)."""
        return self.order * self.teeth[0]

    @property
    def wheel_order(self) -> FloatArray:
        """Cycles per revolution of the driven gear, (K,)."""
        return self.order * self.teeth[1]


def even_positions(period: int) -> FloatArray:
    """Return evenly spaced positions over one period: 4096 a pitch, fewer (256 or more) over a long one."""
    per_pitch = max(min(_PER_PITCH, _PER_PERIOD // period), _FEWEST)
    return np.arange(period * per_pitch) / per_pitch


def spectrum(samples: FloatArray, period: int, teeth: tuple[int, int], error: float) -> Spectrum:
    """Transform the values at `even_positions`, up to the 20th mesh harmonic."""
    count = HARMONICS * period
    lines = np.fft.rfft(samples)[1 : count + 1] * (2.0 / len(samples))
    order = np.arange(1, count + 1) / period
    return Spectrum(order, np.abs(lines), np.angle(lines) % (2.0 * math.pi), error, teeth)
