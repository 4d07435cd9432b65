"""Resultants of force waves on the rotor: torque of r = 0, unbalanced pull of r = 1 and -1.

With the bore radius R, the active length L and the amplitudes P of `ForceWaves`:

- torque = integral of p_t R L R dphi: 2 pi R^2 L Re[P_t exp(-i k Omega t)] of r = 0, none of any other r;
- pull F_x + i F_y = integral of (p_r + i p_t) exp(i phi) L R dphi: pi R L (P_r* + i P_t*) exp(i k Omega t) of
  r = 1, pi R L (P_r + i P_t) exp(-i k Omega t) of r = -1, none of any other r.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.checks import positive
from dynamics.force_waves.waves import ForceWaves
from dynamics.types import ComplexArray, FloatArray, IntArray


@dataclass(frozen=True)
class AirGap:
    """The cylinder on which the pressures act. Raises `InputError`: a size that is not above zero."""

    radius: float
    """Radius of the bore, m."""
    length: float
    """Active length, m."""

    def __post_init__(self) -> None:
        positive("radius", self.radius)
        positive("length", self.length)


@dataclass(frozen=True, eq=False)
class Resultants:
    """Torque and pull on the rotor by temporal order, as amplitudes of exp(+i k Omega t)."""

    temporal_order: IntArray
    """Temporal orders of the waves, increasing. Shape (K,)."""
    torque: ComplexArray
    """Torque about +z, N m: the mean at order 0, ripple at the others. Shape (K,)."""
    pull: ComplexArray
    """Force along x and y, N. Shape (K, 2)."""
    largest_pull: FloatArray
    """Largest force over a period, N: the semi-major axis of its ellipse. Shape (K,)."""


def resultants(waves: ForceWaves, gap: AirGap) -> Resultants:
    """Return torque and pull of the waves on a rotor."""
    orders, row = np.unique(waves.temporal_order, return_inverse=True)
    torque, forward, backward = np.zeros((3, orders.size), dtype=complex)
    area = np.pi * gap.radius * gap.length  # half of the cylinder's
    pressure = waves.radial + 1j * waves.tangential
    conjugate = waves.radial.conj() + 1j * waves.tangential.conj()
    pulsating, with_rotor, against = (waves.spatial_order == r for r in (0, 1, -1))
    torque[row[pulsating]] = 2.0 * area * gap.radius * waves.tangential[pulsating].conj()
    forward[row[with_rotor]] = area * conjugate[with_rotor]
    backward[row[against]] = area * pressure[against]
    pull = np.stack([forward + backward.conj(), -1j * (forward - backward.conj())], axis=-1)
    static = orders == 0  # a pattern that stands still has its real part alone
    torque[static], pull[static] = torque[static].real, pull[static].real
    return Resultants(orders, torque, pull, np.abs(forward) + np.abs(backward))
