"""Orders of a transmission-error curve: mesh harmonics, and the orders between them over a longer period."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bounds import order_name
from bounds.brief import brief
from fe_contact.ste.curve_quantities import HARMONICS
from fe_contact.types import FloatArray

# samples of one pitch, and of a whole period where that would be too many; 256 a pitch leave room for a mesh
# harmonic six times the highest one requested
_SPECTRUM_PER_PITCH, _SPECTRUM_PER_PERIOD, _SPECTRUM_FEWEST = 4096, 2**18, 256


@brief
@dataclass(frozen=True, eq=False)
class Spectrum:
    """Amplitudes of ste(x) = mean + sum A_k cos(2 pi o_k x + phi_k), x in base pitches."""

    order: FloatArray
    """Orders o_k in cycles per base pitch: 1/period, 2/period .. 20. Whole numbers are the mesh harmonics,
    others are sidebands and the orders of single teeth. Shape (K,).
    """
    amplitude: FloatArray
    """Amplitudes A_k, m. Shape (K,)."""
    phase: FloatArray
    """Phases phi_k, rad. Shape (K,)."""
    error: FloatArray
    """Half-widths of the error bands of the amplitudes, m; NaN: not estimated. Shape (K,)."""
    teeth: tuple[int, int]
    """Numbers of teeth of the driving and the driven gear."""

    @property
    def pinion_order(self) -> FloatArray:
        """Orders in cycles per revolution of the driving gear, (K,)."""
        return self.order * self.teeth[0]

    @property
    def wheel_order(self) -> FloatArray:
        """Orders in cycles per revolution of the driven gear, (K,)."""
        return self.order * self.teeth[1]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the orders: of the mesh, of a shaft, or a sideband of the mesh by a shaft.

        "mesh 2", "pinion 11" (11 waves of the pinion: a ghost order), "mesh 1 - pinion 1"; "mesh 1.234" where
        both gears cause the order. Where the numbers of teeth have a common divisor, the pinion's name
        counts.
        """
        shafts = {name: 1.0 / teeth for name, teeth in zip(("pinion", "wheel"), self.teeth, strict=True)}
        return tuple(
            order_name(order, {"mesh": 1.0}, shafts) or f"mesh {order:.4g}" for order in self.order.tolist()
        )


def even_positions(period: int) -> FloatArray:
    """Return evenly spaced positions over one period: 4096 a pitch, fewer (256 or more) over a long one."""
    per_pitch = max(min(_SPECTRUM_PER_PITCH, _SPECTRUM_PER_PERIOD // period), _SPECTRUM_FEWEST)
    return np.arange(period * per_pitch) / per_pitch


def spectrum(samples: FloatArray, period: int, teeth: tuple[int, int], errors: FloatArray) -> Spectrum:
    """Transform the values at `even_positions`, up to the 20th mesh harmonic.

    `errors` (21,) in m are those of all orders beside the mesh orders, and of the mesh orders.
    """
    count = HARMONICS * period
    lines = np.fft.rfft(samples)[1 : count + 1] * (2.0 / len(samples))
    error = np.full(count, errors[0])
    error[period - 1 :: period] = errors[1:]
    order = np.arange(1, count + 1) / period
    return Spectrum(order, np.abs(lines), np.angle(lines) % (2.0 * math.pi), error, teeth)
