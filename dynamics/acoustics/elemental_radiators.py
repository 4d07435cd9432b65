"""Panels as small pistons that work against each other's sound.

References
----------
.. [1] Elliott, S. J.; Johnson, M. E.: Radiation modes and the active control of sound power. J. Acoust. Soc.
   Am. 94 (1993), 2194-2204.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.acoustics.air import Air
from dynamics.acoustics.hull import ComplexArray, Hull
from dynamics.acoustics.plane_waves import mutual_resistance, order_of_waves
from dynamics.types import FloatArray

BLOCK = 512  # panels whose mutual resistances are held at a time


@dataclass(frozen=True)
class ElementalRadiators:
    """Panels smaller than the wavelength; mutual resistance by sin(kr)/(kr) of their distance.

    Attributes
    ----------
    baffled : bool
        True: every panel lies in the same rigid plane (Rayleigh integral, exact for it). False: every panel
        is a monopole in free space; the hull neither scatters nor shadows. It is right for what breathes
        below ka = 0.5, and 3.5 dB low for what oscillates as a whole there; see `multipoles`.
    """

    baffled: bool = False

    @property
    def model_name(self) -> str:
        """Return the name by which results are listed."""
        return "rayleigh_integral" if self.baffled else "monopoles"

    @property
    def solid_angle(self) -> float:
        """Return that into which each panel radiates, sr."""
        return 2.0 * np.pi if self.baffled else 4.0 * np.pi

    def resistance(self, hull: Hull, frequency: float, shapes: ComplexArray, air: Air) -> ComplexArray:
        """Return rho c k^2 / (2 pi or 4 pi) Q^H [sin(kr)/(kr)] Q with the volume velocities Q = S v_n.

        Raises
        ------
        InputError
            The panels are too large for the wavelength.
        """
        wavenumber = 2.0 * np.pi * frequency / air.sound_speed
        hull.require_resolved(wavenumber, air.sound_speed)
        volume_velocity = hull.areas[:, None] * shapes
        if not self.baffled and 2 * order_of_waves(hull.centers, wavenumber) ** 2 < len(shapes):
            total = mutual_resistance(hull.centers, volume_velocity, wavenumber)
        else:
            total = self._by_pairs(hull, volume_velocity, wavenumber)
        scale = 0.5 * air.impedance * wavenumber**2 / self.solid_angle
        return np.asarray(scale * (total + total.conj().T))

    def _by_pairs(self, hull: Hull, volume_velocity: ComplexArray, wavenumber: float) -> ComplexArray:
        """Return Q^H [sin(kr)/(kr)] Q over all pairs of panels."""
        total = np.zeros((volume_velocity.shape[1],) * 2, dtype=volume_velocity.dtype)
        for first in range(0, len(volume_velocity), BLOCK):
            block = slice(first, first + BLOCK)
            mutual = _mutual(hull.centers[block], hull.centers, wavenumber)
            total += volume_velocity[block].conj().T @ (mutual @ volume_velocity)
        return total


def _mutual(rows: FloatArray, columns: FloatArray, wavenumber: float) -> FloatArray:
    """Return sin(kr)/(kr) of the distances between two sets of points, (A, B)."""
    squares = np.sum((rows[:, None] - columns) ** 2, axis=2)
    return np.asarray(np.sinc(wavenumber / np.pi * np.sqrt(squares)))
