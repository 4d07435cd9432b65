"""The medium that carries the sound, and plane waves in it: directions, and the sound of point sources."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bounds import Declared, Kind, between, declared, described
from dynamics.checks import declared_fields
from dynamics.types import ComplexArray, FloatArray

DENSITY = Declared(Kind.INERTIA, "kg/m^3", between(0.1, 10.0), "Density of the air", 1.204)
SOUND_SPEED = Declared(Kind.SPEED, "m/s", between(100.0, 1000.0), "Speed of sound", 343.2)
MARGIN = 12
"""Spherical harmonics above the wavenumber times the radius: what is left out is below 1e-8."""
BLOCK = 2_000_000  # phases that are held at a time


@described
@dataclass(frozen=True)
class Air:
    """A gas at rest without losses; the defaults are air of 20 degrees Celsius at 1013.25 hPa."""

    density: float = declared(1.204, DENSITY)
    sound_speed: float = declared(343.2, SOUND_SPEED)

    def __post_init__(self) -> None:
        declared_fields(self)

    @property
    def impedance(self) -> float:
        """Return rho c, Pa s/m."""
        return self.density * self.sound_speed


def directions(order: int) -> tuple[FloatArray, FloatArray]:
    """Return unit vectors (D, 3) and weights (D,), exact for spherical harmonics below twice the order.

    D is 2 order^2; the opposite of a direction is one of them, and the first half of each ring has none.
    """
    cosine, weight = np.polynomial.legendre.leggauss(order)
    angle = np.arange(2 * order) * np.pi / order
    sine = np.sqrt(1.0 - cosine**2)
    vectors = np.stack(
        [
            np.outer(sine, np.cos(angle)).ravel(),
            np.outer(sine, np.sin(angle)).ravel(),
            np.repeat(cosine, 2 * order),
        ],
        axis=1,
    )
    return vectors, np.repeat(weight, 2 * order) * np.pi / order


def order_of_waves(points: FloatArray, wavenumber: float) -> int:
    """Return the order of directions that resolve the sound of sources at points (P, 3)."""
    return order_of(wavenumber * float(np.linalg.norm(points - points.mean(axis=0), axis=1).max()))


def order_of(ka: float) -> int:
    """Return the order of directions by the wavenumber times the radius of the sources."""
    return int(np.ceil(ka)) + MARGIN


def mutual_resistance(points: FloatArray, strength: ComplexArray, wavenumber: float) -> ComplexArray:
    """Return Q^H [sin(kr)/(kr)] Q of point sources (P, 3) with strengths Q (P, M), (M, M).

    Cost grows with P, not its square, and the result is a sum of squares.
    """
    total = np.zeros((strength.shape[1],) * 2, dtype=strength.dtype)
    for weight, wave in _waves(points, wavenumber):
        far = wave @ strength
        total += far.conj().T @ (weight * far)
    return total


def mutual_pressure(points: FloatArray, strength: ComplexArray, wavenumber: float) -> ComplexArray:
    """Return [sin(kr)/(kr)] Q at the sources themselves, (P, M); parameters as of `mutual_resistance`."""
    total = np.zeros(strength.shape, dtype=strength.dtype)
    for weight, wave in _waves(points, wavenumber):
        total += wave.T @ (weight * (wave @ strength))
    return total


def _waves(points: FloatArray, wavenumber: float) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield weights (D, 1) and standing waves (D, P) whose products add up to sin(kr)/(kr) of the points.

    It is the mean of exp(i k d.(x - y)) over all directions d. Opposite directions give the same: half of
    them are taken, cosine and sine of each.
    """
    order = order_of_waves(points, wavenumber)
    vectors, weights = directions(order)
    half = np.arange(len(vectors)) % (2 * order) < order
    vectors, weights = vectors[half], weights[half] / (2.0 * np.pi)
    arm = points - points.mean(axis=0)
    step = max(BLOCK // len(points), 1)
    for first in range(0, len(vectors), step):
        phase = wavenumber * vectors[first : first + step] @ arm.T
        for wave in (np.cos(phase), np.sin(phase)):
            yield weights[first : first + step, None], wave
