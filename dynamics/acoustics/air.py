"""The air that carries the sound, and the interaction of point sources in it by plane waves.

In the free field the sources x and y, a distance r apart, interact by sin(kr)/(kr), k the wavenumber. It is
the mean of the plane waves exp(i k d.(x - y)) over all directions d. Sums over directions take the place of a
matrix of all pairs of sources. D counts directions, P sources, M columns of source strengths (one for each
mode or load).
"""

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
"""Degrees of spherical harmonics added to the wavenumber times the radius of the sources; the neglected part
of the sound is then below 1e-8.
"""
BLOCK = 2_000_000  # phases (direction times source) in memory at a time


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
        """Characteristic impedance rho c, Pa s/m."""
        return self.density * self.sound_speed


def directions(order: int) -> tuple[FloatArray, FloatArray]:
    """Return unit vectors (D, 3) and weights (D,), exact for spherical harmonics below twice the order.

    The D = 2 order^2 directions lie on `order` rings about the z axis, 2 order of them on each. The opposite
    of every direction is in the set, too. The first half of each ring holds one direction of every such pair.
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
    """Return the order of `directions` that is enough for the sound of sources at points (P, 3)."""
    return order_of(wavenumber * float(np.linalg.norm(points - points.mean(axis=0), axis=1).max()))


def order_of(ka: float) -> int:
    """Return the order of `directions` that is enough for `ka`, wavenumber times radius of the sources."""
    return int(np.ceil(ka)) + MARGIN


def mutual_resistance(points: FloatArray, strength: ComplexArray, wavenumber: float) -> ComplexArray:
    """Return Q^H [sin(kr)/(kr)] Q (M, M) of point sources at points (P, 3) with strengths Q (P, M).

    It is proportional to the power that the sources radiate together. The cost grows with P, not with its
    square. The result is a sum of squares, so that no power comes out negative.
    """
    columns = strength.shape[1]
    total = np.zeros((columns, columns), dtype=strength.dtype)
    for weight, wave in _waves(points, wavenumber):
        far_field = wave @ strength  # (D, M)
        total += far_field.conj().T @ (weight * far_field)
    return total


def mutual_pressure(points: FloatArray, strength: ComplexArray, wavenumber: float) -> ComplexArray:
    """Return [sin(kr)/(kr)] Q (P, M) at the points of the sources; parameters as of `mutual_resistance`."""
    total = np.zeros(strength.shape, dtype=strength.dtype)
    for weight, wave in _waves(points, wavenumber):
        total += wave.T @ (weight * (wave @ strength))
    return total


def _waves(points: FloatArray, wavenumber: float) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield weights (D, 1) and standing waves (D, P) whose products add up to sin(kr)/(kr) of the points.

    The waves of opposite directions are complex conjugates of each other: one of the two is enough, its
    cosine and its sine. The weights of all directions add up to 4 pi; those of one half, over 2 pi, to one.
    """
    order = order_of_waves(points, wavenumber)
    vectors, weights = directions(order)
    half = np.arange(len(vectors)) % (2 * order) < order  # the first half of each ring
    vectors, weights = vectors[half], weights[half] / (2.0 * np.pi)
    from_center = points - points.mean(axis=0)
    step = max(BLOCK // len(points), 1)
    for first in range(0, len(vectors), step):
        phase = wavenumber * vectors[first : first + step] @ from_center.T
        for wave in (np.cos(phase), np.sin(phase)):
            yield weights[first : first + step, None], wave
